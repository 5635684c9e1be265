"""Rule figure_errors: what the surrogate gets wrong on cases that it never saw."""

from pathlib import Path

from storage.netcdf import read_whole
from workflow.report.figures import coefficients, coverage, style, surrogate_errors
from workflow.run import joblog

snakemake = joblog.start(globals())
validation = read_whole(Path(snakemake.input[0])).sel(output=snakemake.params.told)
style.save(coefficients.figure(validation), Path(snakemake.output.decay))
style.save(surrogate_errors.errors(validation), Path(snakemake.output.errors))
style.save(surrogate_errors.residuals(validation), Path(snakemake.output.residuals))
style.save(coverage.figure(validation), Path(snakemake.output.intervals))
