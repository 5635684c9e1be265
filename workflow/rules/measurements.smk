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
