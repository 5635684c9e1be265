"""Rule check: one group of checks of the solver, against independent methods."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from storage.files import write_text
from verification import GROUPS, Sizes
from workflow.run import joblog
from workflow.study import planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
asked = planned.study(snakemake.wildcards.study, snakemake.params.study).verification
assert asked is not None
findings = GROUPS[snakemake.wildcards.group](Sizes(**asked.model_dump()))
write_text(Path(snakemake.output[0]), findings.to_json())
