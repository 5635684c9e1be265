"""Rule figure_errors: what the surrogate gets wrong on cases that it never saw."""

from pathlib import Path

from storage.netcdf import read_whole
from workflow.report.figures import decay, intervals, plots
from workflow.run import joblog

snakemake = joblog.start(globals())
validation = read_whole(Path(snakemake.input[0]))
plots.save(decay.figure(validation), Path(snakemake.output.decay))
plots.save(plots.errors(validation), Path(snakemake.output.errors))
plots.save(plots.parity(validation), Path(snakemake.output.parity))
plots.save(intervals.figure(validation), Path(snakemake.output.intervals))
