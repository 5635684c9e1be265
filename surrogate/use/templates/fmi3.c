/*
 * The functions of FMI 3.0 (Co-Simulation) around {{ name }}.c; C99. Declared after the standard's text,
 * https://fmi-standard.org/docs/3.0/, for they stand in no header of it here.
 */
#include "{{ name }}.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define TOKEN "{{ token }}"
#define INPUTS {{ NAME }}_INPUTS
#define OUTPUTS {{ NAME }}_OUTPUTS
/* Value references: the time, the inputs, value, lower and upper end of each output, the status. */
enum { TIME = 0, FIRST_INPUT = 1, FIRST_OUTPUT = 1 + INPUTS, STATUS = 1 + INPUTS + 3 * OUTPUTS };

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void *fmi3Instance;
typedef uint32_t reference;
typedef void (*logger)(void *environment, fmi3Status status, const char *category, const char *message);
typedef void (*updater)(void);

typedef struct {
    double time;
    {{ name }}_real x[INPUTS];
} model;

static const {{ name }}_real start[INPUTS] = { {{ starts|join(', ') }} };

static model *made(const char *token)
{
    model *instance = NULL;

    if (token != NULL && strcmp(token, TOKEN) == 0) {
        instance = malloc(sizeof(*instance));
    }
    if (instance != NULL) {
        instance->time = 0.0;
        memcpy(instance->x, start, sizeof(start));
    }
    return instance;
}

static double not_a_number(void)
{
    const uint64_t bits = UINT64_C(0x7FF8000000000000);
    double number;

    memcpy(&number, &bits, sizeof(number));
    return number;
}

/* A number of an output: value, lower or upper end; NaN where the status is not OK. */
static double answered(const model *of, int output, int part)
{
    {{ name }}_real found[3];

    if ({{ name }}_interval(output, of->x, &found[0], &found[1], &found[2]) != {{ NAME }}_OK) {
        return not_a_number();
    }
    return (double)found[part];
}

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance i, bool on, size_t n, const char *const names[])
{
    (void)i; (void)on; (void)n; (void)names;
    return fmi3OK;
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(const char *name, const char *token, const char *path, bool visible,
    bool logging, bool events, bool early, const reference required[], size_t n, void *environment, logger log,
    updater update)
{
    (void)name; (void)path; (void)visible; (void)logging; (void)events; (void)early; (void)required; (void)n;
    (void)environment; (void)log; (void)update;
    return made(token);
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(const char *name, const char *token, const char *path, bool visible,
    bool logging, void *environment, logger log)
{
    (void)name; (void)token; (void)path; (void)visible; (void)logging; (void)environment; (void)log;
    return NULL;
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(const char *name, const char *token, const char *path,
    bool visible, bool logging, void *environment, logger log, updater update, updater lock, updater unlock)
{
    (void)name; (void)token; (void)path; (void)visible; (void)logging; (void)environment; (void)log; (void)update;
    (void)lock; (void)unlock;
    return NULL;
}

EXPORT void fmi3FreeInstance(fmi3Instance i) { free(i); }

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance i, bool defined, double tolerance, double time, bool ends,
    double end)
{
    (void)defined; (void)tolerance; (void)ends; (void)end;
    ((model *)i)->time = time;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(fmi3Instance i)
{
    memcpy(((model *)i)->x, start, sizeof(start));
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance i, const reference r[], size_t n, double values[], size_t count)
{
    const model *of = i;
    size_t k;

    for (k = 0; k < n && k < count; k++) {
        if (r[k] == TIME) {
            values[k] = of->time;
        } else if (r[k] < FIRST_OUTPUT) {
            values[k] = (double)of->x[r[k] - FIRST_INPUT];
        } else if (r[k] < STATUS) {
            values[k] = answered(of, (int)(r[k] - FIRST_OUTPUT) / 3, (int)(r[k] - FIRST_OUTPUT) % 3);
        } else {
            return fmi3Error;
        }
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance i, const reference r[], size_t n, const double values[], size_t count)
{
    size_t k;

    for (k = 0; k < n && k < count; k++) {
        if (r[k] < FIRST_INPUT || r[k] >= FIRST_OUTPUT) {
            return fmi3Error;
        }
        ((model *)i)->x[r[k] - FIRST_INPUT] = ({{ name }}_real)values[k];
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetInt32(fmi3Instance i, const reference r[], size_t n, int32_t values[], size_t count)
{
    size_t k;

    for (k = 0; k < n && k < count; k++) {
        if (r[k] != STATUS) {
            return fmi3Error;
        }
        values[k] = (int32_t){{ name }}_inside(((model *)i)->x);
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance i, double time, double step, bool final, bool *event, bool *terminate,
    bool *early, double *last)
{
    (void)final;
    ((model *)i)->time = time + step;
    *event = false;
    *terminate = false;
    *early = false;
    *last = time + step;
    return fmi3OK;
}

static fmi3Status copied(const void *from, void **state)
{
    if (*state == NULL) {
        *state = malloc(sizeof(model));
    }
    if (*state == NULL) {
        return fmi3Error;
    }
    memcpy(*state, from, sizeof(model));
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance i, void **state) { return copied(i, state); }

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance i, void *state)
{
    memcpy(i, state, sizeof(model));
    return fmi3OK;
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance i, void **state)
{
    (void)i;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

/* What needs nothing done. */
#define NOTHING(function) \
    EXPORT fmi3Status function(fmi3Instance i) { (void)i; return fmi3OK; }
NOTHING(fmi3ExitInitializationMode)
NOTHING(fmi3EnterEventMode)
NOTHING(fmi3EnterStepMode)
NOTHING(fmi3Terminate)

/* What no variable of the model has: an error, but for an empty list. */
#define NONE(function, ...) \
    EXPORT fmi3Status function(fmi3Instance i, const reference r[], size_t n, __VA_ARGS__) \
    { (void)i; (void)r; return n == 0 ? fmi3OK : fmi3Error; }
#define NEITHER(type, name) \
    NONE(fmi3Get##name, type values[], size_t count) \
    NONE(fmi3Set##name, const type values[], size_t count)
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
NEITHER(float, Float32)
NEITHER(int8_t, Int8)
NEITHER(uint8_t, UInt8)
NEITHER(int16_t, Int16)
NEITHER(uint16_t, UInt16)
NONE(fmi3SetInt32, const int32_t values[], size_t count)
NEITHER(uint32_t, UInt32)
NEITHER(int64_t, Int64)
NEITHER(uint64_t, UInt64)
NEITHER(bool, Boolean)
NEITHER(const char *, String)
NONE(fmi3GetBinary, size_t sizes[], const uint8_t *values[], size_t count)
NONE(fmi3SetBinary, const size_t sizes[], const uint8_t *const values[], size_t count)
NONE(fmi3GetClock, bool values[])
NONE(fmi3SetClock, const bool values[])
NONE(fmi3GetIntervalDecimal, double intervals[], int qualifiers[])
NONE(fmi3GetIntervalFraction, uint64_t counters[], uint64_t resolutions[], int qualifiers[])
NONE(fmi3GetShiftDecimal, double shifts[])
NONE(fmi3GetShiftFraction, uint64_t counters[], uint64_t resolutions[])
NONE(fmi3SetIntervalDecimal, const double intervals[])
NONE(fmi3SetIntervalFraction, const uint64_t counters[], const uint64_t resolutions[])
NONE(fmi3SetShiftDecimal, const double shifts[])
NONE(fmi3SetShiftFraction, const uint64_t counters[], const uint64_t resolutions[])
NONE(fmi3GetOutputDerivatives, const int32_t orders[], double values[], size_t count)

/* What the description says that the model cannot do. */
#define NEVER(function, ...) \
    EXPORT fmi3Status function(fmi3Instance i, __VA_ARGS__) { return fmi3Error; }
#define NEVER_ALONE(function) \
    EXPORT fmi3Status function(fmi3Instance i) { return fmi3Error; }
NEVER(fmi3GetNumberOfVariableDependencies, reference r, size_t *count)
NEVER(fmi3GetVariableDependencies, reference r, size_t places[], reference on[], size_t their[], int kinds[], size_t n)
NEVER(fmi3SerializedFMUStateSize, void *state, size_t *size)
NEVER(fmi3SerializeFMUState, void *state, uint8_t bytes[], size_t size)
NEVER(fmi3DeserializeFMUState, const uint8_t bytes[], size_t size, void **state)
NEVER(fmi3GetDirectionalDerivative, const reference of[], size_t n, const reference by[], size_t m,
    const double seed[], size_t seeds, double values[], size_t count)
NEVER(fmi3GetAdjointDerivative, const reference of[], size_t n, const reference by[], size_t m,
    const double seed[], size_t seeds, double values[], size_t count)
NEVER_ALONE(fmi3EnterConfigurationMode)
NEVER_ALONE(fmi3ExitConfigurationMode)
NEVER_ALONE(fmi3EvaluateDiscreteStates)
NEVER_ALONE(fmi3EnterContinuousTimeMode)
NEVER(fmi3UpdateDiscreteStates, bool *again, bool *terminate, bool *nominals, bool *values, bool *defined, double *time)
NEVER(fmi3CompletedIntegratorStep, bool final, bool *event, bool *terminate)
NEVER(fmi3SetTime, double time)
NEVER(fmi3SetContinuousStates, const double states[], size_t n)
NEVER(fmi3GetContinuousStateDerivatives, double values[], size_t n)
NEVER(fmi3GetEventIndicators, double values[], size_t n)
NEVER(fmi3GetContinuousStates, double states[], size_t n)
NEVER(fmi3GetNominalsOfContinuousStates, double values[], size_t n)
NEVER(fmi3GetNumberOfEventIndicators, size_t *count)
NEVER(fmi3GetNumberOfContinuousStates, size_t *count)
NEVER(fmi3ActivateModelPartition, reference clock, double time)
