# Exact cases: slabs of the factorial, every quantity of the whole of it, and the card that describes them; first the
# levels, where they are open.


rule levels:
    output:
        "results/{study}/levels.nc",
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation.tolerance"),
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
    priority: 2
    resources:
        mem_mb=partition.MEMORY,
    params:
        study=sections(*PHYSICS, "dataset"),
        regions=regions_of,
        code=provenance.code("workflow/scripts/slab.py"),
    log:
        "logs/{study}/slab/{slab}.log",
    benchmark:
        "logs/{study}/slab/{slab}.tsv"
    script:
        "../scripts/slab.py"


# Of a study of films whose factorial is too large: places in it, asked for round by round from what is known by then.
checkpoint places:
    input:
        lambda wildcards: batches_of(wildcards, int(wildcards.round)),
    output:
        "results/{study}/cross/{round}.nc",
    priority: 2
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "validation.tolerance"),
        code=provenance.code("workflow/scripts/places.py"),
    log:
        "logs/{study}/places/{round}.log",
    script:
        "../scripts/places.py"


rule batch:
    input:
        "results/{study}/cross/{round}.nc",
    output:
        "results/{study}/cross/{round}_{slab}.nc",
    priority: 2
    resources:
        mem_mb=partition.MEMORY,
    params:
        study=sections(*PHYSICS, "dataset", "surrogate"),
        code=provenance.code("workflow/scripts/batch.py"),
    log:
        "logs/{study}/batch/{round}_{slab}.log",
    benchmark:
        "logs/{study}/batch/{round}_{slab}.tsv"
    script:
        "../scripts/batch.py"


rule quantities:
    input:
        lambda wildcards: slabs_of(wildcards, "results/{study}/fields/slab_{slab}.nc"),
    output:
        "results/{study}/quantities.nc",
    priority: 1
    params:
        study=sections(*PHYSICS, "dataset"),
        code=provenance.code("workflow/scripts/quantities.py"),
    log:
        "logs/{study}/quantities.log",
    benchmark:
        "logs/{study}/quantities.tsv"
    script:
        "../scripts/quantities.py"


rule card:
    input:
        slabs=lambda wildcards: slabs_of(wildcards, "results/{study}/fields/slab_{slab}.nc"),
        levels=levels_of,
    output:
        json="results/{study}/datacard.json",
        markdown="results/{study}/datacard.md",
    params:
        study=sections("title", *PHYSICS, "dataset"),
        code=provenance.code("workflow/scripts/card.py"),
    log:
        "logs/{study}/card.log",
    script:
        "../scripts/card.py"
