"""Rule target: one design target, found on the surrogate and solved again exactly."""

from storage.netcdf import write_whole
from surrogate import load
from workflow.design.search import targets
from workflow.design.verdict import netcdf
from workflow.study import planned

snakemake, config = planned.start(globals())
answer = targets.solve_target(config, snakemake.wildcards.name, load(snakemake.input[0]))
write_whole(netcdf.entire(answer), snakemake.output[0])
