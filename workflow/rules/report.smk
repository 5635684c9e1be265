# What people see: figures (also in `snakemake --report`), provenance and the page.


rule figure_fields:
    input:
        lambda wildcards: slabs_of(wildcards, "results/{study}/fields/slab_{slab}.nc"),
    output:
        report(
            "results/{study}/figures/fields.svg",
            caption="../report/captions/fields.rst",
            category="Data set",
            labels={"figure": "surface fields"},
        ),
    params:
        felt=fields_felt,
        code=provenance.code("workflow/scripts/figure_fields.py"),
    log:
        "logs/{study}/figure_fields.log",
    script:
        "../scripts/figure_fields.py"


rule figure_errors:
    input:
        "results/{study}/validation.nc",
    output:
        decay=report(
            "results/{study}/figures/decay.svg",
            caption="../report/captions/decay.rst",
            category="Surrogate",
            labels={"figure": "decay of the coefficients"},
        ),
        errors=report(
            "results/{study}/figures/errors.svg",
            caption="../report/captions/errors.rst",
            category="Surrogate",
            labels={"figure": "errors"},
        ),
        residuals=report(
            "results/{study}/figures/residuals.svg",
            caption="../report/captions/residuals.rst",
            category="Surrogate",
            labels={"figure": "residuals"},
        ),
        intervals=report(
            "results/{study}/figures/intervals.svg",
            caption="../report/captions/intervals.rst",
            category="Surrogate",
            labels={"figure": "intervals"},
        ),
    params:
        told=outputs_told,
        code=provenance.code("workflow/scripts/figure_errors.py"),
    log:
        "logs/{study}/figure_errors.log",
    script:
        "../scripts/figure_errors.py"


rule figure_sensitivity:
    input:
        "results/{study}/sensitivity.nc",
    output:
        indices=report(
            "results/{study}/figures/sensitivity.svg",
            caption="../report/captions/sensitivity.rst",
            category="Surrogate",
            labels={"figure": "Sobol' indices"},
        ),
        effects=report(
            "results/{study}/figures/main_effects.svg",
            caption="../report/captions/main.rst",
            category="Surrogate",
            labels={"figure": "main effects"},
        ),
    params:
        shown=lambda wildcards: study_of(wildcards).of_interest,
        aims=lambda wildcards: study_of(wildcards).aims,
        told=outputs_told,
        code=provenance.code("workflow/scripts/figure_sensitivity.py"),
    log:
        "logs/{study}/figure_sensitivity.log",
    script:
        "../scripts/figure_sensitivity.py"


rule figure_design:
    input:
        "results/{study}/design/{name}.nc",
    output:
        report(
            directory("results/{study}/figures/design_{name}"),
            patterns=["{figure}_{target}.svg"],
            caption="../report/captions/design.rst",
            category="Design",
            labels={"figure": "{figure}", "target": "{target}"},
        ),
    params:
        study=sections(*PHYSICS, "design"),
        code=provenance.code("workflow/scripts/figure_design.py"),
    log:
        "logs/{study}/figure_design/{name}.log",
    script:
        "../scripts/figure_design.py"


rule figure_effect:
    input:
        "results/{study}/fields/effect_{name}.nc",
    output:
        report(
            "results/{study}/figures/effect_{name}.svg",
            caption="../report/captions/effect.rst",
            category="Effects",
            labels={"figure": "surface fields", "factor": "{name}"},
        ),
    params:
        felt=fields_felt,
        code=provenance.code("workflow/scripts/figure_effect.py"),
    log:
        "logs/{study}/figure_effect/{name}.log",
    script:
        "../scripts/figure_effect.py"


rule figure_interior:
    input:
        "results/{study}/fields/interior_{name}.nc",
    output:
        report(
            "results/{study}/figures/interior_{name}.svg",
            caption="../report/captions/interior.rst",
            category="Effects",
            labels={"figure": "below the punch", "factor": "{name}"},
        ),
    params:
        code=provenance.code("workflow/scripts/figure_interior.py"),
    log:
        "logs/{study}/figure_interior/{name}.log",
    script:
        "../scripts/figure_interior.py"


rule provenance:
    input:
        results_of,
    output:
        provenance="results/{study}/provenance.json",
        crate=expand("results/{{study}}/{file}", file=[crate.METADATA, crate.WORKFLOW, crate.STUDY]),
    params:
        title=lambda wildcards: study_of(wildcards).title,
        last=lambda wildcards: study_of(wildcards).final_files,
        study=lambda wildcards: study_of(wildcards).digest(*type(study_of(wildcards)).model_fields),
        seed=lambda wildcards: study_of(wildcards).validation.seed,
        code=provenance.code("workflow/scripts/provenance.py", "workflow/Snakefile"),
    log:
        "logs/{study}/provenance.log",
    script:
        "../scripts/provenance.py"


# so that the page reads files only
rule solved:
    input:
        designs=lambda wildcards: expand(
            "results/{study}/design/{name}.nc", study=wildcards.study, name=study_of(wildcards).design
        ),
        levels=levels_of,
    output:
        "results/{study}/solved.json",
    params:
        study=sections(*PHYSICS, "dataset", "surrogate", "design"),
        code=provenance.code("workflow/scripts/solved.py"),
    log:
        "logs/{study}/solved.log",
    script:
        "../scripts/solved.py"


rule report:
    input:
        lambda wildcards: [f"results/{wildcards.study}/solved.json"] if study_of(wildcards).factors else [],
        results=results_of,
        levels=levels_of,
        designs=lambda wildcards: expand(
            "results/{study}/design/{name}.nc", study=wildcards.study, name=study_of(wildcards).design
        ),
        figures=figures_of,
        folders=lambda wildcards: expand(
            "results/{study}/figures/design_{name}", study=wildcards.study, name=study_of(wildcards).design
        ),
        provenance="results/{study}/provenance.json",
    output:
        "results/{study}/report.html",
    params:
        study=sections(),
        code=provenance.code("workflow/scripts/report.py", *CAPTIONS),
    log:
        "logs/{study}/report.log",
    benchmark:
        "logs/{study}/report.tsv"
    script:
        "../scripts/report.py"
