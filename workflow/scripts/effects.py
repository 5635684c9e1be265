"""Rules effect, interior, map and spread: exact fields, maps or quantities while one factor varies."""

from pathlib import Path

from storage.netcdf import write_whole
from workflow.dataset import effects
from workflow.study import planned

snakemake, config = planned.start(globals())
output = Path(snakemake.output[0])
kind, _, factor = output.stem.partition("_")
write_whole(effects.KINDS[kind](config, factor), output)
