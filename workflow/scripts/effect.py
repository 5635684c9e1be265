"""Rules effect, map, spread and interior: exact fields or quantities while one factor varies."""

from storage.netcdf import write_whole
from workflow.dataset import effects
from workflow.study import planned

snakemake, config = planned.start(globals())
solve = getattr(effects, snakemake.params.solve)
write_whole(solve(config, snakemake.wildcards.name), snakemake.output[0])
