"""Rule readout: how well measurements tell loads, on exact cases, as data and as a figure."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate import load
from surrogate.netcdf import write_whole
from workflow import figures, joblog, planned, readout

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = planned.study(snakemake.wildcards.study, snakemake.params.study)
tried = readout.trial(config, config.readout[snakemake.wildcards.name], load(snakemake.input[0]))
write_whole(tried, Path(snakemake.output.nc))
figures.save(readout.figure(tried), Path(snakemake.output.figure))
