"""Rule levels: level counts that the study leaves open, chosen from pilots."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import write_whole
from workflow import choice, joblog, planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = planned.study(snakemake.wildcards.study, snakemake.params.study)
write_whole(choice.choose(config), Path(snakemake.output[0]))
