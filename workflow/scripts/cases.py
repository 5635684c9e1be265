"""Rule cases: random exact cases, for calibration or validation."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import write_whole
from workflow import joblog, learning, study

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = study.named(snakemake.wildcards.study)
write_whole(learning.cases(config, snakemake.wildcards.sample), Path(snakemake.output[0]))
