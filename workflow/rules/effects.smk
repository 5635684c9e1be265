# The parametric study: exact fields along the surface and below the punch while one factor varies.


rule effect:
    output:
        "results/{study}/fields/effect_{name}.nc",
    params:
        study=sections("phases", "materials", "effects"),
        code=provenance.code("workflow/scripts/effects.py"),
    log:
        "logs/{study}/effect/{name}.log",
    benchmark:
        "logs/{study}/effect/{name}.tsv"
    script:
        "../scripts/effects.py"


rule sweeps:
    input:
        lambda wildcards: expand(
            "results/{study}/fields/effect_{name}.nc", study=wildcards.study, name=study_of(wildcards).effects.of_baseline
        ),
    output:
        "results/{study}/sweeps.nc",
    params:
        factors=lambda wildcards: study_of(wildcards).effects.of_baseline,
        code=provenance.code("workflow/scripts/sweeps.py"),
    log:
        "logs/{study}/sweeps.log",
    localrule: True
    script:
        "../scripts/sweeps.py"


rule map:
    output:
        "results/{study}/fields/map_{name}.nc",
    params:
        study=sections("phases", "materials", "effects"),
        code=provenance.code("workflow/scripts/effects.py"),
    log:
        "logs/{study}/map/{name}.log",
    benchmark:
        "logs/{study}/map/{name}.tsv"
    script:
        "../scripts/effects.py"


rule spread:
    output:
        "results/{study}/fields/spread_{name}.nc",
    params:
        study=sections("phases", "materials", "effects"),
        code=provenance.code("workflow/scripts/effects.py"),
    log:
        "logs/{study}/spread/{name}.log",
    benchmark:
        "logs/{study}/spread/{name}.tsv"
    script:
        "../scripts/effects.py"


rule interior:
    output:
        "results/{study}/fields/interior_{name}.nc",
    params:
        study=sections("phases", "materials", "effects"),
        code=provenance.code("workflow/scripts/effects.py"),
    log:
        "logs/{study}/interior/{name}.log",
    benchmark:
        "logs/{study}/interior/{name}.tsv"
    script:
        "../scripts/effects.py"
