"""Rule cases: random exact cases, for calibration or validation."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import write_whole
from workflow import factorial, joblog, study

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = study.named(snakemake.wildcards.study)
write_whole(factorial.cases(config, snakemake.wildcards.sample), Path(snakemake.output[0]))
