"""Rule design: all targets in one file and one table."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from storage.files import write_text
from storage.netcdf import read_whole, write_whole
from workflow.design import answers
from workflow.run import joblog

snakemake: Snakemake

joblog.start(snakemake.log[0])
designs = [read_whole(Path(answer)) for answer in snakemake.input]
write_whole(answers.together(designs), Path(snakemake.output.nc))
write_text(Path(snakemake.output.csv), answers.table(designs))
