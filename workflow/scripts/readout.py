"""Rule readout: how well measurements tell loads, on exact cases."""

from pathlib import Path

from storage.netcdf import write_whole
from surrogate import load
from workflow.learning import readout_trial
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
tried = readout_trial.trial(config, config.readout[snakemake.wildcards.name], load(snakemake.input[0]))
write_whole(tried, Path(snakemake.output[0]))
