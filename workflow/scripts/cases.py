"""Rules cases and calibration: random exact cases, some for validation and others for calibration."""

from pathlib import Path

from storage.netcdf import write_whole
from workflow.dataset import casecache, factorial
from workflow.study import planned

snakemake, config = planned.start(globals())
output = Path(snakemake.output[0])
with casecache.of(snakemake) as cache:
    write_whole(factorial.cases(config, output.stem, cache), output)
