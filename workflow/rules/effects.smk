# The parametric study: exact surface fields while one factor varies.


rule effect:
    output:
        "results/{study}/fields/effect_{name}.nc",
    params:
        study=sections("phases", "materials", "effects"),
        code=provenance.code("workflow/scripts/effect.py"),
    log:
        "logs/{study}/effect/{name}.log",
    benchmark:
        "logs/{study}/effect/{name}.tsv"
    script:
        "../scripts/effect.py"
