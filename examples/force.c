/*
 * The load on a contact sensor, from its voltage and its temperature, as a controller estimates it: about 60 evaluations
 * of the exported surrogate, without allocation, in a time that depends on no input.
 *
 *   meecontact export results/quickstart --as c --outputs voltage -o sensor.c
 *   cc -std=c89 -ffp-contract=off force.c sensor.c -lm -o force
 *   ./force -480 45     the voltage [V] and the temperature [Celsius]
 */
#include "sensor.h"
#include <stdio.h>
#include <stdlib.h>

/* The sensor: volume fraction, friction, radius [m], load [N/m], which is sought, and charge [C/m]. */
static const double SENSOR[SENSOR_INPUTS] = {0.67, 0.2, 0.12, 0.0, 0.0};
static const double LOADS[2] = {3e3, 3e5};
/* Change of the voltage with the temperature [1/K], about the one of the surrogate. Measured on each sensor. */
static const double DRIFT = -1.5e-3, REFERENCE = 25.0;

enum { VALUE, LOWER, UPPER };

/* The load at which the value, or an end of its interval, is the voltage: bisection over the box. */
static int load_at(double voltage, int part, double *load)
{
    double x[SENSOR_INPUTS], answer[3], first, low = LOADS[0], high = LOADS[1];
    int k, step, status = SENSOR_OK;

    for (k = 0; k < SENSOR_INPUTS; k++) {
        x[k] = SENSOR[k];
    }
    x[SENSOR_LOAD] = low;
    status = sensor_interval(SENSOR_VOLTAGE, x, &answer[VALUE], &answer[LOWER], &answer[UPPER]);
    if (status != SENSOR_OK) {
        return status;
    }
    first = answer[part] - voltage;
    x[SENSOR_LOAD] = high;
    status = sensor_interval(SENSOR_VOLTAGE, x, &answer[VALUE], &answer[LOWER], &answer[UPPER]);
    if (status != SENSOR_OK || !(first * (answer[part] - voltage) <= 0.0)) {
        return SENSOR_OUTSIDE;
    }
    for (step = 0; step < 20; step++) {
        x[SENSOR_LOAD] = 0.5 * (low + high);
        status = sensor_interval(SENSOR_VOLTAGE, x, &answer[VALUE], &answer[LOWER], &answer[UPPER]);
        if (status != SENSOR_OK) {
            return status;
        }
        if (first * (answer[part] - voltage) > 0.0) {
            low = x[SENSOR_LOAD];
        } else {
            high = x[SENSOR_LOAD];
        }
    }
    *load = 0.5 * (low + high);
    return SENSOR_OK;
}

int main(int count, char *words[])
{
    double voltage, load, ends[2], swapped;

    if (count != 3) {
        fputs("force: a voltage [V] and a temperature [Celsius]\n", stderr);
        return 2;
    }
    voltage = atof(words[1]) / (1.0 + DRIFT * (atof(words[2]) - REFERENCE));
    if (load_at(voltage, VALUE, &load) != SENSOR_OK || load_at(voltage, LOWER, &ends[0]) != SENSOR_OK
        || load_at(voltage, UPPER, &ends[1]) != SENSOR_OK) {
        fputs("force: no load of the box has this voltage\n", stderr);
        return 1;
    }
    if (ends[0] > ends[1]) {
        swapped = ends[0];
        ends[0] = ends[1];
        ends[1] = swapped;
    }
    printf("%.1f N/m [%.1f, %.1f]\n", load, ends[0], ends[1]);
    return 0;
}
