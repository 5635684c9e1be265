"""Rule map: exact maps of contacts in space while one factor varies."""

from pathlib import Path

from storage.netcdf import write_whole
from workflow.dataset import effects
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
write_whole(effects.maps(config, snakemake.wildcards.name), Path(snakemake.output[0]))
