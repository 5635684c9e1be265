# Exact cases: slabs of the factorial, and every quantity of the whole of it; first its levels, where they are open.


rule levels:
    output:
        "results/{study}/levels.nc",
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation"),
        code=provenance.code("workflow/scripts/levels.py"),
    log:
        "logs/{study}/levels.log",
    benchmark:
        "logs/{study}/levels.tsv"
    script:
        "../scripts/levels.py"


rule slab:
    input:
        levels=levels_of,
    output:
        "results/{study}/fields/slab_{slab}.nc",
    params:
        study=sections(*PHYSICS, "dataset"),
        code=provenance.code("workflow/scripts/slab.py"),
    log:
        "logs/{study}/slab/{slab}.log",
    benchmark:
        "logs/{study}/slab/{slab}.tsv"
    script:
        "../scripts/slab.py"


rule quantities:
    input:
        lambda wildcards: expand(
            "results/{study}/fields/slab_{slab}.nc",
            study=wildcards.study,
            slab=range(factorial.slab_count(study_of(wildcards))),
        ),
    output:
        "results/{study}/quantities.nc",
    params:
        code=provenance.code("workflow/scripts/quantities.py"),
    log:
        "logs/{study}/quantities.log",
    benchmark:
        "logs/{study}/quantities.tsv"
    script:
        "../scripts/quantities.py"
