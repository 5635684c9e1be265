"""Rule readout: how well measurements tell loads, on exact cases, as data and as a figure."""

from pathlib import Path

from storage.netcdf import write_whole
from surrogate import load
from workflow.learning import readout_trial
from workflow.report.figures import readout_intervals, style
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
tried = readout_trial.trial(config, config.readout[snakemake.wildcards.name], load(snakemake.input[0]))
write_whole(tried, Path(snakemake.output.nc))
style.save(readout_intervals.figure(tried), Path(snakemake.output.figure))
