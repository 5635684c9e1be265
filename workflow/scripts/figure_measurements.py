"""Rule figure_measurements: every row, measured and modelled, on one axis."""

import json
from pathlib import Path

from workflow.report.figures import measured_rows, style
from workflow.run import joblog

snakemake = joblog.start(globals())
rows = json.loads(Path(snakemake.input[0]).read_text(encoding="utf-8"))
style.save(measured_rows.figure(rows), Path(snakemake.output[0]))
