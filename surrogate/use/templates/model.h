{{ comment }}
#ifndef {{ NAME }}_H
#define {{ NAME }}_H

#define {{ NAME }}_INPUTS {{ inputs|length }}
#define {{ NAME }}_OUTPUTS {{ outputs|length }}

/* Inputs: places in x. */
{% for input in inputs %}
#define {{ NAME }}_{{ input.macro }} {{ loop.index0 }} /* {{ input.text }} */
{% endfor %}

/* Outputs: the first argument of the functions. */
{% for output in outputs %}
#define {{ NAME }}_{{ output.macro }} {{ loop.index0 }} /* {{ output.text }} */
{% endfor %}

/* Status. With any but OK the functions write nothing. */
#define {{ NAME }}_OK 0
#define {{ NAME }}_OUTSIDE 1    /* an input beyond the range of the box */
#define {{ NAME }}_NOT_NORMAL 2 /* an input that is NaN, infinite or denormal */
#define {{ NAME }}_NO_OUTPUT 4  /* a number of no output */

typedef {{ real }} {{ name }}_real;

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a point has answers. */
int {{ name }}_inside(const {{ name }}_real x[{{ inputs|length }}]);

/* The value of an output. */
int {{ name }}_value(int output, const {{ name }}_real x[{{ inputs|length }}], {{ name }}_real *value);

/* The value and the ends of its 95 % interval, which the rounding has widened. */
int {{ name }}_interval(int output, const {{ name }}_real x[{{ inputs|length }}], {{ name }}_real *value,
    {{ name }}_real *lower, {{ name }}_real *upper);

/* The derivatives of an output by the inputs, in its unit over theirs. */
int {{ name }}_gradient(int output, const {{ name }}_real x[{{ inputs|length }}],
    {{ name }}_real gradient[{{ inputs|length }}]);

#ifdef {{ NAME }}_SELFTEST
/* Number of stored predictions of the surrogate that do not come out again: 0. */
int {{ name }}_selftest(void);
#endif

#ifdef __cplusplus
}
#endif
#endif
