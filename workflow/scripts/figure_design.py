"""Rule figure_design: the figures of one design target."""

from pathlib import Path

from workflow.design.verdict import netcdf
from workflow.report.figures import design_plots, style
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
target = planned.study(snakemake).design[snakemake.wildcards.name]
folder = Path(snakemake.output[0])
folder.mkdir(exist_ok=True)
for name, figure in design_plots.figures_of(netcdf.read(Path(snakemake.input[0])), target).items():
    style.save(figure, folder / f"{name}_{snakemake.wildcards.name}.svg")
