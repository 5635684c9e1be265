"""Rule measurements: published measurements beside what the model says."""

import json
from pathlib import Path

from storage.files import write_text
from storage.netcdf import write_whole
from workflow.measured import comparison
from workflow.study import planned

snakemake, config = planned.start(globals())
rows = comparison.compared(config.measurements)
write_whole(comparison.dataset(rows), snakemake.output.numbers)
write_text(Path(snakemake.output.rows), json.dumps(rows, indent=1, ensure_ascii=False) + "\n")
