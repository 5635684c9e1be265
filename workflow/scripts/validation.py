"""Rule validation: errors on exact cases that the surrogate never saw, and both times."""

import json
from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate import load
from surrogate.netcdf import read_whole, write_whole
from workflow import choice, joblog, learning, planned, timing
from workflow.files import write_text

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = choice.resolved(planned.study(snakemake.wildcards.study, snakemake.params.study), snakemake.input.levels)
quantities = read_whole(Path(snakemake.input.quantities))
model = load(snakemake.input.surrogate)
cases = read_whole(Path(snakemake.input.cases))
write_whole(learning.validate(config, quantities, cases, model), Path(snakemake.output.validation))
times = timing.timing(config, quantities, cases, model)
write_text(Path(snakemake.output.timing), json.dumps(times, indent=2) + "\n")
