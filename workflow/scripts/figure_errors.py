"""Rule figure_errors: what the surrogate gets wrong on cases that it never saw."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import read_whole
from workflow import decay, figures, intervals, joblog

snakemake: Snakemake

joblog.start(snakemake.log[0])
validation = read_whole(Path(snakemake.input[0]))
figures.save(decay.figure(validation), Path(snakemake.output.decay))
figures.save(figures.errors(validation), Path(snakemake.output.errors))
figures.save(figures.parity(validation), Path(snakemake.output.parity))
figures.save(intervals.figure(validation), Path(snakemake.output.intervals))
