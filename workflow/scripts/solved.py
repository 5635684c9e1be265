"""Rule solved: what the page tells of exact cases."""

import json
from pathlib import Path

from storage.files import write_text
from workflow.dataset import levels
from workflow.design.verdict import netcdf
from workflow.report import exact
from workflow.study import planned

snakemake, config = planned.start(globals())
config = levels.with_levels(config, snakemake.input.levels)
designs = {Path(file).stem: netcdf.read(Path(file)) for file in snakemake.input.designs}
write_text(Path(snakemake.output[0]), json.dumps(exact.solved(config, designs), indent=1) + "\n")
