# What people see: figures (also in `snakemake --report`), provenance and the page.


# what figures ask of a study, by the name that their entries in `sections.py` give it
ASKED = {
    "felt": fields_felt,
    "quantities": learned_quantities,
    "aims": lambda wildcards: coupling.aims(study_of(wildcards)),
    "of_interest": lambda wildcards: coupling.of_interest(study_of(wildcards)),
}

for drawn in page_sections.drawn():
    _, first = drawn[0]

    rule:
        name:
            f"figure_{first.kind}"
        input:
            drawn_from(first.reads),
        output:
            *(
                report(
                    f"results/{{study}}/figures/{figure.file}.svg",
                    caption=f"../report/captions/{figure.kind}.rst",
                    category=section.title,
                    labels=figure.labels,
                )
                for section, figure in drawn
            ),
        params:
            draw=[(figure.draw, figure.asks) for _, figure in drawn],
            slabs="{slab}" in first.reads,
            **{name: ASKED[name] for _, figure in drawn for name in figure.asks},
            code=provenance.code("workflow/scripts/figure.py", *sorted({figure.source for _, figure in drawn})),
        log:
            f"logs/{{study}}/figure_{first.kind}" + (f"_{{{first.wildcard}}}" if first.wildcard else "") + ".log",
        localrule: True
        script:
            "../scripts/figure.py"


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
        study=sections(*PHYSICS, "design.{name}"),
        felt=fields_felt,
        code=provenance.code("workflow/scripts/figure_design.py"),
    log:
        "logs/{study}/figure_design/{name}.log",
    script:
        "../scripts/figure_design.py"


rule provenance:
    input:
        results_of,
    output:
        provenance="results/{study}/provenance.json",
        study="results/{study}/study.yaml",
    params:
        study=lambda wildcards: study_of(wildcards).digest(*type(study_of(wildcards)).model_fields),
        seed=lambda wildcards: study_of(wildcards).validation.seed,
        code=provenance.code("workflow/scripts/provenance.py"),
    log:
        "logs/{study}/provenance.log",
    script:
        "../scripts/provenance.py"


# so that the page reads files only
rule solved:
    input:
        designs=of_designs("results/{study}/design/{name}.nc"),
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
        opening=opening_of,
        designs=of_designs("results/{study}/design/{name}.nc"),
        figures=figures_of,
        folders=of_designs("results/{study}/figures/design_{name}"),
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
