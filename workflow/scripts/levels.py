"""Rule levels: level counts that the study leaves open, chosen from pilots."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from storage.netcdf import write_whole
from workflow.dataset import levels
from workflow.run import joblog
from workflow.study import planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = planned.study(snakemake.wildcards.study, snakemake.params.study)
write_whole(levels.choose(config), Path(snakemake.output[0]))
