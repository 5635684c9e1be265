"""Rule figure_convergence: errors of the independent methods as they are refined."""

import json
from pathlib import Path

from workflow.report.figures import convergence, style
from workflow.run import joblog

snakemake = joblog.start(globals())
findings = json.loads(Path(snakemake.input[0]).read_text(encoding="utf-8"))
style.save(convergence.figure(findings["curves"]), Path(snakemake.output[0]))
