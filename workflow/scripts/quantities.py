"""Rule quantities: every quantity of the factorial, gathered from its slabs."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import read_whole, write_whole
from workflow import factorial, joblog

snakemake: Snakemake

joblog.start(snakemake.log[0])
write_whole(factorial.gather([read_whole(Path(slab)) for slab in snakemake.input]), Path(snakemake.output[0]))
