"""Rule effect: exact surface fields while one factor varies."""

from storage.netcdf import write_whole
from workflow.dataset import effects
from workflow.study import planned

snakemake, config = planned.start(globals())
write_whole(effects.effect(config, snakemake.wildcards.name), snakemake.output[0])
