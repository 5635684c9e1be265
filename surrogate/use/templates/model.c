{{ comment }}
#include "{{ name }}.h"
#include <math.h>

typedef {{ name }}_real real;
{% macro array(type, label, values, per=8) -%}
static const {{ type }} {{ label }}[] = {
{% for row in values|batch(per) %}
    {{ row|join(', ') }}{{ '' if loop.last else ',' }}
{% endfor %}
};
{% endmacro %}

#define INPUTS {{ inputs|length }}
#define AXES {{ axes }}
#define MODES {{ modes }}
#define RANK {{ rank }}
#define TERMS {{ terms }}
#define DEGREES {{ degrees }}
#define SLABS 10

/* One output: the train of its mean, and its interval (docs/format.md of meecontact, sections 2 to 4). */
typedef struct {
    const {{ storage }} *cores;
    unsigned short modes[AXES];
    unsigned short ranks[AXES + 1];
    real offset;
    real rounding; /* largest error of the rounding */
    real amplitude[AXES];
    real aliased[AXES];
    real part[AXES];
    real spread; /* what deviations are in units of */
    real floor;
    real trend_low;
    real trend_high;
    real lower;
    real upper;
    const float *trend;
    const float *slabs;
    const float *corners;
{% if outer %}
    const float *outer_slabs;
    const float *outer_corners;
    real outer_pooled;
{% endif %}
{% if grouped %}
    real power[INPUTS];
    real added;
    int sign;
{% endif %}
} table;

{% for output in outputs %}
/* {{ output.text }} */
{{ array(storage, 'cores_' ~ loop.index0, output.cores) }}
{{ array('float', 'trend_' ~ loop.index0, output.trend) }}
{{ array('float', 'slabs_' ~ loop.index0, output.slabs, 10) }}
{{ array('float', 'corners_' ~ loop.index0, output.corners) }}
{% if outer %}
{{ array('float', 'outer_slabs_' ~ loop.index0, output.outer_slabs, 10) }}
{{ array('float', 'outer_corners_' ~ loop.index0, output.outer_corners) }}
{% endif %}
{% endfor %}
static const table tables[{{ outputs|length }}] = {
{% for output in outputs %}
    { cores_{{ loop.index0 }}, { {{ output.modes|join(', ') }} }, { {{ output.ranks|join(', ') }} }, {{ output.offset }}, {{ output.rounding }},
      { {{ output.amplitude|join(', ') }} },
      { {{ output.aliased|join(', ') }} },
      { {{ output.part|join(', ') }} },
      {{ output.spread }}, {{ output.floor }}, {{ output.trend_low }}, {{ output.trend_high }}, {{ output.lower }}, {{ output.upper }},
      trend_{{ loop.index0 }}, slabs_{{ loop.index0 }}, corners_{{ loop.index0 }}
{%- if outer %},
      outer_slabs_{{ loop.index0 }}, outer_corners_{{ loop.index0 }}, {{ output.outer_pooled }}
{%- endif %}
{%- if grouped %},
      { {{ output.power|join(', ') }} }, {{ output.added }}, {{ output.sign }}
{%- endif %}
 }{{ '' if loop.last else ',' }}
{% endfor %}
};

static const unsigned char order[AXES] = { {{ order|join(', ') }} };
static const real ends[INPUTS][2] = {
{% for input in inputs %}
    { {{ input.low }}, {{ input.high }} }{{ '' if loop.last else ',' }}
{% endfor %}
};
/* Of every axis: the number of its levels, the kernel's decay, and what the levels leave unknown over its first part. */
static const unsigned short levels[AXES] = { {{ levels|join(', ') }} };
static const unsigned short kernel_terms[AXES] = { {{ kernel_terms|join(', ') }} };
static const unsigned short unknown_terms[AXES] = { {{ unknown_terms|join(', ') }} };
{% for axis in kernels %}
{{ array('float', 'kernel_' ~ loop.index0, axis.kernel) }}
{{ array('float', 'unknown_' ~ loop.index0, axis.unknown) }}
{% endfor %}
static const float *const kernels[AXES] = { {% for axis in kernels %}kernel_{{ loop.index0 }}{{ '' if loop.last else ', ' }}{% endfor %} };
static const float *const unknowns[AXES] = { {% for axis in kernels %}unknown_{{ loop.index0 }}{{ '' if loop.last else ', ' }}{% endfor %} };
static const unsigned char trend_degree[TERMS][AXES] = {
{% for row in trend_degree %}
    { {{ row|join(', ') }} }{{ '' if loop.last else ',' }}
{% endfor %}
};
{% if grouped %}
static const real added_power[INPUTS] = { {{ added_power|join(', ') }} };
{% endif %}

/* Whether a number is zero or normal: by its bits, since -ffast-math takes comparisons with NaN for granted. */
static int is_normal(const real *number)
{
    static const real one = {{ one }};
    const unsigned char *byte = (const unsigned char *)number;
    const int last = (int)sizeof(real) - 1;
    const int little = ((const unsigned char *)&one)[last] != 0;
    const int high = byte[little ? last : 0];
    const int next = byte[little ? last - 1 : 1];
    const int exponent = ((high & 0x7F) << {{ shift }}) | (next >> {{ 8 - shift }});
    int any = high & 0x7F;
    int k;

    for (k = 0; k <= last; k++) {
        if (k != (little ? last : 0)) {
            any |= byte[k];
        }
    }
    return (exponent != {{ largest }}) && ((exponent != 0) || (any == 0));
}

static real within(real value, real low, real high)
{
    real nearest = value;

    if (nearest < low) {
        nearest = low;
    }
    if (nearest > high) {
        nearest = high;
    }
    return nearest;
}
{% if outer %}

/* Scaled inputs, from -1 to 1. */
static void box(const real x[INPUTS], real t[INPUTS])
{
{% for input in inputs %}
    t[{{ loop.index0 }}] = within({{ input.unit }}, {{ minus_one }}, {{ one }});
{% endfor %}
}
{% endif %}

/* Scaled coordinates of the axes, from -1 to 1. */
static void scaled(const real x[INPUTS], real t[AXES])
{
{% for text in units %}
    t[{{ loop.index0 }}] = within({{ text }}, {{ minus_one }}, {{ one }});
{% endfor %}
}

/* Derivatives of the axes' scaled coordinates by the inputs. */
static void steepness(const real x[INPUTS], real slope[AXES][INPUTS])
{
{% for row in slopes %}
{% set k = loop.index0 %}
{% for text in row %}
    slope[{{ k }}][{{ loop.index0 }}] = {{ text }};
{% endfor %}
{% endfor %}
{% if not reads_x %}
    (void)x;
{% endif %}
}

/* Chebyshev polynomials, or their derivatives, of one coordinate. */
static void polynomials(real t, int count, int derived, real T[])
{
    real value = {{ one }}, next = t, slope = {{ zero }}, next_slope = {{ one }}, after;
    int m;

    for (m = 0; m < count; m++) {
        T[m] = derived ? slope : value;
        after = {{ two }} * next + {{ two }} * t * next_slope - slope;
        slope = next_slope;
        next_slope = after;
        after = {{ two }} * t * next - value;
        value = next;
        next = after;
    }
}

/* The mean without its offset, or its derivative by one of the axes. */
static real contracted(const table *of, const real t[AXES], int derived)
{
    real state[RANK], result[RANK], T[MODES];
    const {{ storage }} *core = of->cores;
    int k, a, b, m;

    state[0] = {{ one }};
    for (k = 0; k < AXES; k++) {
        const int rows = of->ranks[k], columns = of->ranks[k + 1], modes = of->modes[k];

        polynomials(t[order[k]], modes, derived == (int)order[k], T);
        for (b = 0; b < columns; b++) {
            result[b] = {{ zero }};
        }
        for (a = 0; a < rows; a++) {
            for (m = 0; m < modes; m++) {
                const real weight = state[a] * T[m];

                for (b = 0; b < columns; b++) {
                    result[b] += weight * (real)core[b];
                }
                core += columns;
            }
        }
        for (b = 0; b < columns; b++) {
            state[b] = result[b];
        }
    }
    return state[0];
}
{% if grouped %}

/* What the learnt value is multiplied by, and what is added to it before. */
static real scale(const table *of, const real x[INPUTS], real *added)
{
    real exponent = {{ zero }}, sum = {{ zero }};

{% for input in inputs %}
{% if input.relative %}
    {
        const real logarithm = {{ input.relative }};

        exponent += of->power[{{ loop.index0 }}] * logarithm;
        sum += added_power[{{ loop.index0 }}] * logarithm;
    }
{% endif %}
{% endfor %}
{% if not scales_read %}
    (void)x;
{% endif %}
    *added = of->added * sum;
    return {{ exp }}(exponent);
}
{% endif %}

/* The output of a learnt value: with its derivative by this value. */
static real output_of(const table *of, const real x[INPUTS], real learnt, real *size)
{
    real value = learnt;
{% if grouped %}
    real added;
    const real factor = scale(of, x, &added);
{% endif %}

    *size = {{ one }};
{% if grouped %}
    value += added;
    if (of->sign == 0) {
        *size = factor;
        value *= factor;
    } else {
        *size = factor * {{ exp }}((real)of->sign * value);
        value = (real)of->sign * *size;
    }
{% else %}
    (void)of;
    (void)x;
{% endif %}
    return value;
}

/* The slab of a scaled coordinate, shifted by a share of its width. */
static int slab(real t, real shift)
{
    return (int)within((t + {{ one }}) / {{ two }} * (real)SLABS + shift, {{ zero }}, (real)(SLABS - 1));
}

/* The largest guard of the slabs and corners that hold a point; where slabs meet, of both. */
static real guarded(const float slabs[], const float corners[], const real t[], int count, int *corner)
{
    real largest = {{ minus_one }}, guard;
    int below, above, edge, end, i, j, pair = 0;

    *corner = 0;
    for (i = 0; i < count; i++) {
        for (above = -1; above < 2; above += 2) {
            guard = (real)slabs[i * SLABS + slab(t[i], (real)above * {{ near }})];
            largest = (guard > largest) ? guard : largest;
        }
    }
    for (i = 0; i < count; i++) {
        below = (slab(t[i], -{{ near }}) == 0);
        above = (slab(t[i], {{ near }}) == SLABS - 1);
        for (j = i + 1; j < count; j++) {
            edge = (slab(t[j], -{{ near }}) == 0);
            end = (slab(t[j], {{ near }}) == SLABS - 1);
            if ((below || above) && (edge || end)) {
                guard = (real)corners[4 * pair + (above ? 2 : 0) + (end ? 1 : 0)];
                *corner = 1;
                largest = (guard > largest) ? guard : largest;
            }
            pair++;
        }
    }
    return largest;
}

/* The standard deviation of the learnt value. */
static real deviation(const table *of, const real t[AXES])
{
    real T[AXES][DEGREES], unknown = {{ zero }}, known = {{ one }}, trend = {{ zero }};
    real value, next, after, sum, rest, prior, alias;
    int corner, k, m, last;

    for (k = 0; k < AXES; k++) {
        value = {{ one }};
        next = t[k];
        sum = {{ zero }};
        rest = {{ zero }};
        prior = {{ zero }};
        last = (int)levels[k] + 1;
        if (last < (int)kernel_terms[k]) {
            last = (int)kernel_terms[k];
        }
        for (m = 0; m < last; m++) {
            if (m < (int)kernel_terms[k]) {
                prior += (real)kernels[k][m] * value * value;
            }
            if (m < (int)unknown_terms[k]) {
                rest += (real)unknowns[k][m] * value * value;
            }
            if (m == (int)levels[k]) {
                sum = value * value;
            }
            after = {{ two }} * t[k] * next - value;
            value = next;
            next = after;
        }
        prior = {{ one }} + of->amplitude[k] * prior;
        alias = of->aliased[k] * rest * sum;
        unknown = unknown * prior + known * alias * of->part[k];
        known *= prior - alias;
        polynomials(t[k], DEGREES, 0, T[k]);
    }
    for (m = 0; m < TERMS; m++) {
        value = (real)of->trend[m];
        for (k = 0; k < AXES; k++) {
            value *= T[k][trend_degree[m][k]];
        }
        trend += value;
    }
    trend = within(trend, of->trend_low, of->trend_high);
    trend += guarded(of->slabs, of->corners, t, AXES, &corner);
    return of->spread * {{ sqrt }}(unknown + of->floor) * {{ exp }}(trend);
}

int {{ name }}_inside(const {{ name }}_real x[{{ inputs|length }}])
{
    int status = {{ NAME }}_OK;
    int k;

    for (k = 0; k < INPUTS; k++) {
        if (!is_normal(&x[k])) {
            status = {{ NAME }}_NOT_NORMAL;
        }
    }
    for (k = 0; (k < INPUTS) && (status == {{ NAME }}_OK); k++) {
        if ((x[k] < ends[k][0]) || (x[k] > ends[k][1])) {
            status = {{ NAME }}_OUTSIDE;
        }
    }
    return status;
}

static int checked(int output, const real x[INPUTS])
{
    int status = {{ name }}_inside(x);

    if ((output < 0) || (output >= {{ outputs|length }})) {
        status = {{ NAME }}_NO_OUTPUT;
    }
    return status;
}

int {{ name }}_value(int output, const {{ name }}_real x[{{ inputs|length }}], {{ name }}_real *value)
{
    const int status = checked(output, x);

    if (status == {{ NAME }}_OK) {
        const table *of = &tables[output];
        real t[AXES], size, result;

        scaled(x, t);
        result = output_of(of, x, of->offset + contracted(of, t, -1), &size);
        *value = result;
    }
    return status;
}

int {{ name }}_interval(int output, const {{ name }}_real x[{{ inputs|length }}], {{ name }}_real *value,
    {{ name }}_real *lower, {{ name }}_real *upper)
{
    const int status = checked(output, x);

    if (status == {{ NAME }}_OK) {
        const table *of = &tables[output];
        real t[AXES], size, result, std, low, high;
{% if outer %}
        real y[INPUTS], guard;
        int corner;
{% endif %}

        scaled(x, t);
        result = output_of(of, x, of->offset + contracted(of, t, -1), &size);
        std = deviation(of, t) * size;
{% if outer %}
        box(x, y);
        guard = guarded(of->outer_slabs, of->outer_corners, y, INPUTS, &corner);
        if ((corner != 0) && (of->outer_pooled > guard)) {
            guard = of->outer_pooled;
        }
        std *= {{ exp }}(guard);
{% endif %}
        low = result + of->lower * std;
        high = result + of->upper * std;
        *value = result;
        low -= of->rounding;
        high += of->rounding;
        *lower = low;
        *upper = high;
    }
    return status;
}

int {{ name }}_gradient(int output, const {{ name }}_real x[{{ inputs|length }}],
    {{ name }}_real gradient[{{ inputs|length }}])
{
    const int status = checked(output, x);

    if (status == {{ NAME }}_OK) {
        const table *of = &tables[output];
        real t[AXES], slope[AXES][INPUTS], along[AXES], size, sum{{ ', value' if grouped }};
        int i, k;

        scaled(x, t);
        steepness(x, slope);
        for (k = 0; k < AXES; k++) {
            along[k] = contracted(of, t, k);
        }
{% if grouped %}
        value = output_of(of, x, of->offset + contracted(of, t, -1), &size);
{% else %}
        size = {{ one }};
{% endif %}
        for (i = 0; i < INPUTS; i++) {
            sum = {{ zero }};
            for (k = 0; k < AXES; k++) {
                sum += along[k] * slope[k][i];
            }
{% if grouped %}
            if ((of->power[i] != {{ zero }}) || (added_power[i] != {{ zero }})) {
                sum += of->added * added_power[i] / x[i];
                sum = size * sum + value * of->power[i] / x[i];
            } else {
                sum *= size;
            }
{% else %}
            sum *= size;
{% endif %}
            gradient[i] = sum;
        }
    }
    return status;
}
#ifdef {{ NAME }}_SELFTEST

static const real probes[{{ probes|length }}][INPUTS] = {
{% for row in probes %}
    { {{ row|join(', ') }} }{{ '' if loop.last else ',' }}
{% endfor %}
};
/* Of every probe and output: value, lower and upper end of the interval. */
static const real expected[{{ probes|length }}][{{ outputs|length }}][3] = {
{% for probe in expected %}
    {
{% for row in probe %}
        { {{ row|join(', ') }} }{{ '' if loop.last else ',' }}
{% endfor %}
    }{{ '' if loop.last else ',' }}
{% endfor %}
};
static const real allowed[{{ outputs|length }}] = { {{ allowed|join(', ') }} };

int {{ name }}_selftest(void)
{
    real found[3];
    int failures = 0, k, p, part, status;

    for (k = 0; k < {{ probes|length }}; k++) {
        for (p = 0; p < {{ outputs|length }}; p++) {
            status = {{ name }}_interval(p, probes[k], &found[0], &found[1], &found[2]);
            for (part = 0; part < 3; part++) {
                if ((status != {{ NAME }}_OK) || !(fabs((double)(found[part] - expected[k][p][part])) <= (double)allowed[p])) {
                    failures++;
                }
            }
        }
    }
    return failures;
}
#endif
