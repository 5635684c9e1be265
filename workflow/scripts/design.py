"""Rule design: all targets in one file and one table."""

from pathlib import Path

from storage.files import write_text
from storage.netcdf import read_whole, write_whole
from workflow.design.verdict import answers
from workflow.run import joblog

snakemake = joblog.start(globals())
designs = [read_whole(Path(answer)) for answer in snakemake.input]
write_whole(answers.together(designs), Path(snakemake.output.nc))
write_text(Path(snakemake.output.csv), answers.table(designs))
