"""Rule report: the self-contained page."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from workflow import choice, joblog, planned, report
from workflow.files import write_text

snakemake: Snakemake

joblog.start(snakemake.log[0])
output = Path(snakemake.output[0])
name = snakemake.wildcards.study
figures = [Path(figure) for figure in snakemake.input.figures]
figures += [figure for folder in snakemake.input.folders for figure in sorted(Path(folder).glob("*.svg"))]
config = choice.resolved(planned.study(name, snakemake.params.study), snakemake.input.levels)
page = report.page(config, name, output.parent, figures, Path(snakemake.input.provenance), snakemake.input.levels)
write_text(output, page)
