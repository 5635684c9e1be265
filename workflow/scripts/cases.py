"""Rule cases: random exact cases, some for calibration and others for validation."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from storage.netcdf import write_whole
from workflow.dataset import factorial
from workflow.run import joblog
from workflow.study import planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = planned.study(snakemake.wildcards.study, snakemake.params.study)
for sample in factorial.SAMPLES:
    write_whole(factorial.cases(config, sample), Path(snakemake.output[sample]))
