"""Rule effect: exact surface fields while one factor varies."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from storage.netcdf import write_whole
from workflow.dataset import effects
from workflow.run import joblog
from workflow.study import planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = planned.study(snakemake.wildcards.study, snakemake.params.study)
write_whole(effects.effect(config, snakemake.wildcards.name), Path(snakemake.output[0]))
