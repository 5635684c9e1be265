"""Rule asked: the cases that the surrogate asks for in a round, from all that it has been given."""

from pathlib import Path

from storage.netcdf import read_whole
from workflow.dataset import infill, levels
from workflow.design.search import targets
from workflow.learning import training
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = levels.with_levels(planned.study(snakemake), snakemake.input.levels)
quantities = read_whole(Path(snakemake.input.quantities))
further = [read_whole(Path(slab)) for slab in snakemake.input.further]
known = infill.joined(read_whole(Path(snakemake.input.calibration)), further)
model = training.calibrated(config, training.fit(config, quantities), quantities, known)
name, number = snakemake.wildcards.name, int(snakemake.wildcards.round)
place = targets.doubted(config, name, model) if config.design else training.widest(config, model, number)
infill.write(config, place, number, Path(snakemake.output[0]))
