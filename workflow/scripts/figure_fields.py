"""Rule figure_fields: surface fields of some cases of the data set."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import read_whole
from workflow import figures, joblog

snakemake: Snakemake

joblog.start(snakemake.log[0])
with read_whole(Path(snakemake.input[0]), lazy=True) as slab:
    figures.save(figures.fields(slab), Path(snakemake.output[0]))
