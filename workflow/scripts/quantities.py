"""Rule quantities: every quantity of the factorial, gathered from its slabs."""

from solver.names import ALL_QUANTITIES
from storage.netcdf import read_whole, write_whole
from workflow.dataset.slabs import gather
from workflow.run import joblog

snakemake = joblog.start(globals())
slabs = [read_whole(slab, names=ALL_QUANTITIES) for slab in snakemake.input]
write_whole(gather(slabs), snakemake.output[0])
