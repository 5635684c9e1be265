"""Rule gathered: all cases that a target asks for, in one file."""

from pathlib import Path

from storage.netcdf import read_whole, write_whole
from workflow.dataset import infill
from workflow.run import joblog

snakemake = joblog.start(globals())
write_whole(infill.gathered([read_whole(Path(slab)) for slab in snakemake.input]), Path(snakemake.output[0]))
