"""Rule places: the places that a cross approximation asks for in a round, from all cases that it has been given."""

from pathlib import Path

from storage.netcdf import read_whole
from workflow.dataset import batches
from workflow.learning import training
from workflow.study import planned

snakemake, config = planned.start(globals())
solved = [read_whole(slab) for slab in snakemake.input]
batches.write_places(config, training.places(config, solved), Path(snakemake.output[0]))
