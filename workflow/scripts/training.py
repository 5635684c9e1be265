"""Rule surrogate: the Gaussian process on the factorial, its intervals calibrated."""

from pathlib import Path

from storage.netcdf import read_whole
from surrogate import save
from workflow.learning import curves, training
from workflow.study import planned

snakemake, config = planned.start(globals())
quantities = read_whole(snakemake.input.quantities)
model = training.fit(config, curves.joined(config, quantities, snakemake.input.slabs))
model.calibrate(curves.training_data(config, read_whole(snakemake.input.calibration)))
save(model, Path(snakemake.output[0]))
