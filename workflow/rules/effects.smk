# The parametric study: exact fields along the surface and below the punch while one factor varies.


# rule and files' name, and the function that solves them
for varied, solving in {"effect": "effect", "map": "maps", "spread": "spread", "interior": "interior"}.items():

    rule:
        name:
            varied
        output:
            f"results/{{study}}/fields/{varied}_{{name}}.nc",
        params:
            study=sections("phases", "materials", "effects"),
            solve=solving,
            code=provenance.code("workflow/scripts/effect.py"),
        log:
            f"logs/{{study}}/{varied}/{{name}}.log",
        benchmark:
            f"logs/{{study}}/{varied}/{{name}}.tsv"
        script:
            "../scripts/effect.py"


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
