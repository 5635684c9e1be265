"""Rule figure_sensitivity: Sobol' indices of every quantity, main effects of some."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import read_whole
from workflow import figures, influence, joblog

snakemake: Snakemake

joblog.start(snakemake.log[0])
sensitivity = read_whole(Path(snakemake.input[0]))
figures.save(influence.indices(sensitivity), Path(snakemake.output.indices))
figures.save(influence.main_effects(sensitivity, snakemake.params.shown), Path(snakemake.output.effects))
