"""Rule surrogate: the Gaussian process on the factorial, its intervals calibrated."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import read_whole
from workflow import factorial, joblog, learning, planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = planned.study(snakemake.wildcards.study, snakemake.params.study)
model = learning.fit(config, read_whole(Path(snakemake.input.quantities)))
model.calibrate(factorial.learned(config, read_whole(Path(snakemake.input.calibration))))
model.save(Path(snakemake.output[0]))
