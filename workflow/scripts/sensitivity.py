"""Rule sensitivity: exact Sobol' indices and main effects of the surrogate, with intervals."""

from storage.described import described
from storage.netcdf import write_whole
from surrogate import load
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.use.sensitivity import sobol
from workflow.study import planned

snakemake, config = planned.start(globals())
quantiles = {name: stated.quantile for name, stated in config.distributions.items()}
model = load(snakemake.input[0])
units = [model.attrs_[name].get("units", "") for name in model.outputs_]
indices = sobol(model, quantiles).assign_coords(units=("output", units))
title = "Sobol' indices and main effects of the surrogate"
write_whole(described(indices, title, SOURCE, MEANINGS), snakemake.output[0])
