"""Rule figure_fields: surface fields of some cases of the data set."""

from contextlib import ExitStack
from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import read_whole
from workflow import figures, joblog

snakemake: Snakemake

joblog.start(snakemake.log[0])
with ExitStack() as stack:
    slabs = [stack.enter_context(read_whole(Path(file), lazy=True)) for file in snakemake.input]
    figures.save(figures.fields(slabs), Path(snakemake.output[0]))
