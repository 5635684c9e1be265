"""Rule surrogate: the Gaussian process on the factorial, its intervals calibrated."""

from pathlib import Path

from storage.netcdf import read_whole
from surrogate import save
from workflow.dataset import infill
from workflow.learning import curves, training
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
quantities = read_whole(Path(snakemake.input.quantities))
model = training.fit(config, curves.joined(config, quantities, snakemake.input.slabs))
further = [read_whole(Path(slab)) for slab in snakemake.input.further]
known = infill.joined(read_whole(Path(snakemake.input.calibration)), further)
model = training.calibrated(config, model, quantities, known)
save(model, Path(snakemake.output[0]))
