"""Rule readout: how well measurements tell loads, on exact cases."""

from storage.netcdf import write_whole
from surrogate import load
from workflow.learning import readout_trial
from workflow.study import planned

snakemake, config = planned.start(globals())
tried = readout_trial.trial(config, config.readout[snakemake.wildcards.name], load(snakemake.input[0]))
write_whole(tried, snakemake.output[0])
