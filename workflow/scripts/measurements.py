"""Rule measurements: published measurements beside what the model says."""

import json
from pathlib import Path

from storage.files import write_text
from storage.netcdf import write_whole
from workflow.measured import comparison
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
rows = comparison.compared(planned.study(snakemake).measurements)
write_whole(comparison.dataset(rows), Path(snakemake.output.numbers))
write_text(Path(snakemake.output.rows), json.dumps(rows, indent=1, ensure_ascii=False) + "\n")
