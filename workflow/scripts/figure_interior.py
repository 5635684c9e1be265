"""Rule figure_interior: the effect of one factor on the fields below the punch."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import read_whole
from workflow import figures, joblog

snakemake: Snakemake

joblog.start(snakemake.log[0])
figures.save(figures.interior(read_whole(Path(snakemake.input[0]))), Path(snakemake.output[0]))
