"""Rule card: what the data set holds, for programs and for people."""

import json
from pathlib import Path

from snakemake.iocontainers import Snakemake

from storage.files import write_text
from workflow.dataset import datacard, levels
from workflow.run import joblog
from workflow.study import planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
name = snakemake.wildcards.study
config = levels.resolved(planned.study(name, snakemake.params.study), snakemake.input.levels)
slabs = [Path(slab) for slab in snakemake.input.slabs]
times = [Path(snakemake.log[0]).with_name("slab") / f"{number}.tsv" for number in range(len(slabs))]
card = datacard.card(config, name, slabs, times)
write_text(Path(snakemake.output.json), json.dumps(card, indent=1) + "\n")
write_text(Path(snakemake.output.markdown), datacard.markdown(card))
