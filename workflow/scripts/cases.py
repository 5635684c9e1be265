"""Rule cases: random exact cases, some for calibration and others for validation."""

from pathlib import Path

from storage.netcdf import write_whole
from workflow.dataset import factorial
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
for sample in factorial.SAMPLES:
    write_whole(factorial.cases(config, sample), Path(snakemake.output[sample]))
