# Statistics: the Gaussian process on the factorial, and exact cases that it never saw.


rule surrogate:
    input:
        "results/{study}/quantities.nc",
    output:
        "results/{study}/surrogate.nc",
    params:
        study=sections("surrogate", "factors"),
        code=provenance.code("workflow/scripts/surrogate.py"),
    log:
        "logs/{study}/surrogate.log",
    benchmark:
        "logs/{study}/surrogate.tsv"
    script:
        "../scripts/surrogate.py"


rule validation:
    input:
        quantities="results/{study}/quantities.nc",
        surrogate="results/{study}/surrogate.nc",
    output:
        validation="results/{study}/validation.nc",
        timing="results/{study}/timing.json",
    params:
        study=sections(*PHYSICS, "validation"),
        code=provenance.code("workflow/scripts/validation.py"),
    log:
        "logs/{study}/validation.log",
    benchmark:
        "logs/{study}/validation.tsv"
    script:
        "../scripts/validation.py"
