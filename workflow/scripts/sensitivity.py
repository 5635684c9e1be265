"""Rule sensitivity: exact Sobol' indices and main effects of the surrogate, with intervals."""

from pathlib import Path

from storage.described import described
from storage.netcdf import write_whole
from surrogate import load
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.use.sensitivity import sobol
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
quantiles = {name: stated.quantile for name, stated in planned.study(snakemake).distributions.items()}
model = load(snakemake.input[0]).everywhere()  # indices are those of the whole box
units = [model.attrs_[name].get("units", "") for name in model.outputs_]
indices = sobol(model, quantiles).assign_coords(units=("output", units))
write_whole(
    described(indices, "Sobol' indices and main effects of the surrogate", SOURCE, MEANINGS), Path(snakemake.output[0])
)
