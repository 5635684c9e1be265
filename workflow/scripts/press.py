"""Rule press: a press in time on a design, as data."""

from pathlib import Path

from storage.netcdf import write_whole
from workflow.design.verdict import netcdf
from workflow.device import pressed
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
assert config.signal is not None  # the rule is of studies that have it
answer = netcdf.read(Path(snakemake.input[0]))
shown = pressed.signal(config.narrowed(answer.kinds), config.signal, {**config.fixed, **answer.kinds, **answer.case})
write_whole(shown, Path(snakemake.output[0]))
