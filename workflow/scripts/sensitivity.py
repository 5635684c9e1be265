"""Rule sensitivity: exact Sobol' indices and main effects of the surrogate, with intervals."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate import load
from surrogate.netcdf import write_whole
from surrogate.sensitivity import sobol
from workflow import joblog

snakemake: Snakemake

joblog.start(snakemake.log[0])
model = load(snakemake.input[0])
units = [model.attrs_[name].get("units", "") for name in model.outputs_]
write_whole(sobol(model).assign_coords(units=("output", units)), Path(snakemake.output[0]))
