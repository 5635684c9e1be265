"""Rule card: what the data set holds, for programs and for people."""

import json
from pathlib import Path

from storage.files import write_text
from workflow.dataset import datacard, levels
from workflow.study import planned

snakemake, config = planned.start(globals())
name = snakemake.wildcards.study
config = levels.with_levels(config, snakemake.input.levels)
slabs = [Path(slab) for slab in snakemake.input.slabs]
kind = "batch" if config.crossed else "slab"
times = [Path(snakemake.log[0]).with_name(kind) / f"{slab.stem.removeprefix('slab_')}.tsv" for slab in slabs]
card = datacard.card(config, name, slabs, times)
write_text(Path(snakemake.output.json), json.dumps(card, indent=1) + "\n")
write_text(Path(snakemake.output.markdown), datacard.markdown(card))
