"""Rule surrogate: the Gaussian process on the factorial, its intervals calibrated."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from storage.netcdf import read_whole
from surrogate import save
from workflow.dataset import factorial
from workflow.learning import training
from workflow.run import joblog
from workflow.study import planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = planned.study(snakemake.wildcards.study, snakemake.params.study)
model = training.fit(config, read_whole(Path(snakemake.input.quantities)))
model.calibrate(factorial.learned(config, read_whole(Path(snakemake.input.calibration))))
save(model, Path(snakemake.output[0]))
