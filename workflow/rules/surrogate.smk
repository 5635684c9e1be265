# Statistics: the Gaussian process on the factorial, and random exact cases, by which it is calibrated and validated.


rule cases:
    output:
        "results/{study}/cases/validation.nc",
    priority: 3  # of films they take longest
    params:
        study=sections(BOX, "dataset.peaks", "validation.seed", "validation.cases"),
        regions=regions_of,
        code=provenance.code("workflow/scripts/cases.py"),
    log:
        "logs/{study}/cases.log",
    benchmark:
        "logs/{study}/cases.tsv"
    script:
        "../scripts/cases.py"


rule calibration:
    output:
        "results/{study}/cases/calibration.nc",
    priority: 3  # of films they take longest
    params:
        study=sections(BOX, "dataset.peaks", "validation.seed", "validation.calibration"),
        regions=regions_of,
        code=provenance.code("workflow/scripts/cases.py"),
    log:
        "logs/{study}/calibration.log",
    benchmark:
        "logs/{study}/calibration.tsv"
    script:
        "../scripts/cases.py"


rule surrogate:
    input:
        slabs=curves_of,
        quantities="results/{study}/quantities.nc",
        calibration="results/{study}/cases/calibration.nc",
    output:
        "results/{study}/surrogate.nc",
    priority: 1
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation.tolerance"),
        code=provenance.code("workflow/scripts/training.py"),
    log:
        "logs/{study}/surrogate.log",
    benchmark:
        "logs/{study}/surrogate.tsv"
    script:
        "../scripts/training.py"


rule validation:
    input:
        slabs=curves_of,
        quantities="results/{study}/quantities.nc",
        cases="results/{study}/cases/validation.nc",
        surrogate="results/{study}/surrogate.nc",
        levels=levels_of,
    output:
        validation="results/{study}/validation.nc",
        timing="results/{study}/timing.json",
    priority: 1
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation.tolerance", "validation.seed"),
        code=provenance.code("workflow/scripts/validation.py"),
    log:
        "logs/{study}/validation.log",
    benchmark:
        "logs/{study}/validation.tsv"
    script:
        "../scripts/validation.py"


rule sensitivity:
    input:
        "results/{study}/surrogate.nc",
    output:
        "results/{study}/sensitivity.nc",
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation.tolerance", "design"),
        code=provenance.code("workflow/scripts/sensitivity.py"),
    log:
        "logs/{study}/sensitivity.log",
    benchmark:
        "logs/{study}/sensitivity.tsv"
    script:
        "../scripts/sensitivity.py"


rule surface:
    input:
        levels=levels_of,
    output:
        model="results/{study}/surface.nc",
        validation="results/{study}/surface_validation.nc",
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation"),
        code=provenance.code("workflow/scripts/surface.py"),
    log:
        "logs/{study}/surface.log",
    benchmark:
        "logs/{study}/surface.tsv"
    script:
        "../scripts/surface.py"
