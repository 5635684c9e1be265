"""Rule map: exact maps of contacts in space while one factor varies."""

from storage.netcdf import write_whole
from workflow.dataset import effects
from workflow.study import planned

snakemake, config = planned.start(globals())
write_whole(effects.maps(config, snakemake.wildcards.name), snakemake.output[0])
