# Design targets: found on the surrogate, solved again exactly.


rule target:
    input:
        "results/{study}/surrogate.nc",
    output:
        "results/{study}/design/{name}.nc",
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation.tolerance", "device", "design.{name}"),
        code=provenance.code("workflow/scripts/target.py"),
    log:
        "logs/{study}/target/{name}.log",
    benchmark:
        "logs/{study}/target/{name}.tsv"
    script:
        "../scripts/target.py"


rule design:
    input:
        designs_of,
    output:
        nc="results/{study}/design.nc",
        csv="results/{study}/design.csv",
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation.tolerance", "device", "design"),
        code=provenance.code("workflow/scripts/design.py"),
    log:
        "logs/{study}/design.log",
    benchmark:
        "logs/{study}/design.tsv"
    script:
        "../scripts/design.py"


# From measurements back to loads.
rule readout:
    input:
        "results/{study}/surrogate.nc",
    output:
        "results/{study}/readout/{name}.nc",
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation.seed", "readout.{name}"),
        code=provenance.code("workflow/scripts/readout.py"),
    log:
        "logs/{study}/readout/{name}.log",
    benchmark:
        "logs/{study}/readout/{name}.tsv"
    script:
        "../scripts/readout.py"


# A press in time on a design, of this study or of another, as the amplifier reads it.
rule press:
    input:
        pressed_of,
    output:
        "results/{study}/signal.nc",
    params:
        study=sections(*PHYSICS, "device", "signal"),
        code=provenance.code("workflow/scripts/press.py"),
    log:
        "logs/{study}/press.log",
    script:
        "../scripts/press.py"
