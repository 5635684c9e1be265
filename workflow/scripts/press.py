"""Rule press: a press in time on a design, of this study or of another, as data."""

from pathlib import Path

from storage.netcdf import write_whole
from workflow.design.verdict import netcdf
from workflow.device import pressed
from workflow.study import planned

snakemake, config = planned.start(globals())
assert config.signal is not None  # the rule is of studies that have it
answer = netcdf.read(Path(snakemake.input[0]))
study = planned.pressed(snakemake, config)
case = {**study.fixed, **answer.combination, **answer.case}
write_whole(pressed.signal(study.narrowed(answer.combination), config.signal, case), snakemake.output[0])
