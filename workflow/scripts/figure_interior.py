"""Rule figure_interior: the effect of one factor on the fields below the punch."""

from pathlib import Path

from storage.netcdf import read_whole
from workflow.report.figures import field_panels, style
from workflow.run import joblog

snakemake = joblog.start(globals())
style.save(field_panels.interior(read_whole(Path(snakemake.input[0]))), Path(snakemake.output[0]))
