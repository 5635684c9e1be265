"""Rule figure_sensitivity: Sobol' indices of every quantity, main effects of some."""

from pathlib import Path

from storage.netcdf import read_whole
from workflow.report.figures import sobol, style
from workflow.run import joblog

snakemake = joblog.start(globals())
sensitivity = read_whole(Path(snakemake.input[0]))
style.save(sobol.indices(sensitivity), Path(snakemake.output.indices))
style.save(sobol.main_effects(sensitivity, snakemake.params.shown), Path(snakemake.output.effects))
