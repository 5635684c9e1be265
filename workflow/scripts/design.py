"""Rule design: all targets in one file and one table."""

from pathlib import Path

from storage.files import write_text
from storage.netcdf import read_whole, write_whole
from workflow.design.verdict import netcdf
from workflow.design.wording import table
from workflow.run import joblog

snakemake = joblog.start(globals())
designs = [read_whole(answer) for answer in snakemake.input]
write_whole(netcdf.together(designs), snakemake.output.nc)
write_text(Path(snakemake.output.csv), table.as_csv(map(netcdf.answer_of, designs)))
