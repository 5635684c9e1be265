"""Rule levels: level counts that the study leaves open, chosen from pilots."""

from storage.netcdf import write_whole
from workflow.dataset import levels
from workflow.study import planned

snakemake, config = planned.start(globals())
write_whole(levels.choose(config), snakemake.output[0])
