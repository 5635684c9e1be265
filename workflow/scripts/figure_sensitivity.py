"""Rule figure_sensitivity: Sobol' indices of every quantity, main effects of some."""

from pathlib import Path

from storage.netcdf import read_whole
from workflow.report.figures import plots
from workflow.report.figures import sensitivity as influence
from workflow.run import joblog

snakemake = joblog.start(globals())
sensitivity = read_whole(Path(snakemake.input[0]))
plots.save(influence.indices(sensitivity), Path(snakemake.output.indices))
plots.save(influence.main_effects(sensitivity, snakemake.params.shown), Path(snakemake.output.effects))
