"""Rule report: the self-contained page."""

from pathlib import Path

from storage.files import write_text
from workflow.dataset import levels
from workflow.report import page as report
from workflow.study import planned

snakemake, config = planned.start(globals())
output = Path(snakemake.output[0])
name = snakemake.wildcards.study
figures = [Path(figure) for figure in snakemake.input.figures]
figures += [figure for folder in snakemake.input.folders for figure in sorted(Path(folder).glob("*.svg"))]
config = levels.with_levels(config, snakemake.input.levels)
pressed = planned.pressed(snakemake, config) if config.signal and config.signal.study else None
provenance, levels_files = Path(snakemake.input.provenance), snakemake.input.levels
page = report.page(config, name, output.parent, figures, provenance, levels_files, pressed)
write_text(output, page)
