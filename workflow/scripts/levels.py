"""Rule levels: level counts that the study leaves open, chosen from pilots."""

from pathlib import Path

from storage.netcdf import write_whole
from workflow.dataset import levels
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
write_whole(levels.choose(config), Path(snakemake.output[0]))
