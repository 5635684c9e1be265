"""Rules cases and calibration: random exact cases, some for validation and others for calibration."""

from pathlib import Path

from storage.netcdf import write_whole
from workflow.dataset import factorial
from workflow.dataset.kept import Kept
from workflow.run import joblog, lock
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
output = Path(snakemake.output[0])
kept = Kept(lock.results(snakemake.wildcards.study, output), output)
write_whole(factorial.cases(config, output.stem, kept), output)
kept.tell()
