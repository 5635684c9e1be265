"""Rule card: what the data set holds, for programs and for people."""

import json
from pathlib import Path

from snakemake.iocontainers import Snakemake

from workflow import choice, datacard, joblog, planned
from workflow.files import write_text

snakemake: Snakemake

joblog.start(snakemake.log[0])
name = snakemake.wildcards.study
config = choice.resolved(planned.study(name, snakemake.params.study), snakemake.input.levels)
slabs = [Path(slab) for slab in snakemake.input.slabs]
times = [Path(snakemake.log[0]).with_name("slab") / f"{number}.tsv" for number in range(len(slabs))]
card = datacard.card(config, name, slabs, times)
write_text(Path(snakemake.output.json), json.dumps(card, indent=1) + "\n")
write_text(Path(snakemake.output.markdown), datacard.markdown(card))
