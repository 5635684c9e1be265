"""Rule surrogate: the Gaussian process on the factorial, its intervals calibrated."""

from pathlib import Path

from storage.netcdf import read_whole
from surrogate import save
from workflow.learning import curves, training
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
quantities = read_whole(Path(snakemake.input.quantities))
model = training.fit(config, curves.joined(config, quantities, snakemake.input.slabs))
calibration = read_whole(Path(snakemake.input.calibration))
model = training.calibrated(config, model, quantities, calibration)
save(model, Path(snakemake.output[0]))
