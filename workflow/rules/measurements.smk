# Does the model agree with measurements? The rows of the study beside what the solver says, nothing fitted.

rule measurements:
    output:
        rows="results/{study}/measured/measurements.json",
        numbers="results/{study}/measured/measurements.nc",
    params:
        study=sections("measurements"),
        code=provenance.code("workflow/scripts/measurements.py"),
    log:
        "logs/{study}/measurements.log",
    script:
        "../scripts/measurements.py"


rule figure_measurements:
    input:
        "results/{study}/measured/measurements.json",
    output:
        report(
            "results/{study}/figures/measurements.svg",
            caption="../report/captions/measurements.rst",
            category="Measurements",
            labels={"figure": "measured and modelled"},
        ),
    params:
        code=provenance.code("workflow/scripts/figure_measurements.py"),
    log:
        "logs/{study}/figure_measurements.log",
    script:
        "../scripts/figure_measurements.py"
