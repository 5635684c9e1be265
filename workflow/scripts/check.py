"""Rule check: one group of checks of the solver, against independent methods."""

from pathlib import Path

from storage.files import write_text
from verification import GROUPS, Sizes
from workflow.study import planned

snakemake, config = planned.start(globals())
sizes = config.verification
assert sizes is not None
findings = GROUPS[snakemake.wildcards.group](Sizes(**sizes.model_dump()))
write_text(Path(snakemake.output[0]), findings.to_json())
