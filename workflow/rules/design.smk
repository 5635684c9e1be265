# Design targets: found on the surrogate, solved again exactly.


rule target:
    input:
        "results/{study}/surrogate.nc",
    output:
        "results/{study}/design/{name}.nc",
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation", "device", "design"),
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
        nc="results/{study}/readout/{name}.nc",
        figure=report(
            "results/{study}/figures/readout_{name}.svg",
            caption="../report/captions/readout.rst",
            category="Design",
            labels={"figure": "read-out", "target": "{name}"},
        ),
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation", "readout"),
        code=provenance.code("workflow/scripts/readout.py"),
    log:
        "logs/{study}/readout/{name}.log",
    benchmark:
        "logs/{study}/readout/{name}.tsv"
    script:
        "../scripts/readout.py"
