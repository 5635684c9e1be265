"""Rule figure_sensitivity: Sobol' indices of every quantity, main effects of some."""

from pathlib import Path

from storage.files import write_text
from storage.netcdf import read_whole
from workflow.report import ranked
from workflow.report.figures import sobol, style, tornado
from workflow.run import joblog

snakemake = joblog.start(globals())
sensitivity = read_whole(Path(snakemake.input[0])).sel(output=snakemake.params.told)
write_text(Path(snakemake.output.indices), tornado.draw(ranked.sensitivities(sensitivity, snakemake.params.aims)))
style.save(sobol.main_effects(sensitivity, snakemake.params.shown), Path(snakemake.output.effects))
