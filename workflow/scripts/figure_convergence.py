"""Rule figure_convergence: errors of the independent methods as they are refined."""

import json
from pathlib import Path

from workflow.report.figures import plots
from workflow.run import joblog

snakemake = joblog.start(globals())
findings = json.loads(Path(snakemake.input[0]).read_text(encoding="utf-8"))
plots.save(plots.convergence(findings["curves"]), Path(snakemake.output[0]))
