"""Rule validation: errors on exact cases that the surrogate never saw, and both times."""

import json
from pathlib import Path

from storage.files import write_text
from storage.netcdf import read_whole, write_whole
from surrogate import load
from workflow.dataset import levels
from workflow.learning import curves, timing, training
from workflow.study import planned

snakemake, config = planned.start(globals())
config = levels.with_levels(config, snakemake.input.levels)
quantities = read_whole(snakemake.input.quantities)
model = load(snakemake.input.surrogate)
cases = read_whole(snakemake.input.cases)
write_whole(training.validate(config, quantities, cases, model), snakemake.output.validation)
quantities = curves.joined(config, quantities, snakemake.input.slabs)
times = timing.timing(config, quantities, cases, model)
write_text(Path(snakemake.output.timing), json.dumps(times, indent=2) + "\n")
