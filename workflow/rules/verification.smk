# Is the solver right? Groups of checks against independent methods, in verification/; the run fails if one is red.

rule check:
    output:
        "results/{study}/verification/{group}.json",
    params:
        study=sections("verification"),
        code=provenance.code("workflow/scripts/check.py"),  # and all of verification/, which it imports
    threads: lambda wildcards: workflow.cores if wildcards.group == "integral_equations" else 1  # timed: alone
    log:
        "logs/{study}/check/{group}.log",
    benchmark:
        "logs/{study}/check/{group}.tsv"
    script:
        "../scripts/check.py"


rule verdict:
    input:
        # after the page, which then shows what is red
        "results/{study}/report.html",
        checks=expand("results/{{study}}/verification/{group}.json", group=CHECK_GROUPS),
    output:
        "results/{study}/verdict.txt",
    params:
        code=provenance.code("workflow/scripts/verdict.py"),
    log:
        "logs/{study}/verdict.log",
    script:
        "../scripts/verdict.py"
