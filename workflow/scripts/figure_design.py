"""Rule figure_design: the figures of one design target."""

from dataclasses import replace
from pathlib import Path

from storage.files import write_text
from workflow.design.verdict import netcdf
from workflow.report import ranked
from workflow.report.figures import design_plots, style
from workflow.study import planned

snakemake, config = planned.start(globals())
target = config.design[snakemake.wildcards.name]
folder = Path(snakemake.output[0])
folder.mkdir(exist_ok=True)
answer = netcdf.read(Path(snakemake.input[0]))
answer = replace(answer, pictures=style.felt_only(answer.pictures, snakemake.params.felt))
if "bars" in ranked.names(target):
    bars = ranked.draw(ranked.elasticities(answer))
    write_text(folder / f"bars_{snakemake.wildcards.name}.svg", bars)
for name, figure in design_plots.figures_of(answer, target).items():
    style.save(figure, folder / f"{name}_{snakemake.wildcards.name}.svg")
