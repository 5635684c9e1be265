"""Rules figure_...: the figures of the page that are drawn from the same results."""

import json
from contextlib import ExitStack
from importlib import import_module
from pathlib import Path
from typing import Any

from storage.netcdf import read_whole
from workflow.report.figures import style
from workflow.run import joblog

snakemake = joblog.start(globals())
with ExitStack() as stack:
    data: Any
    if snakemake.params.slabs:
        data = [stack.enter_context(read_whole(file, lazy=True)) for file in snakemake.input]
    elif Path(snakemake.input[0]).suffix == ".json":
        data = json.loads(Path(snakemake.input[0]).read_text(encoding="utf-8"))
    else:
        data = read_whole(snakemake.input[0])
    for (draw, arguments), file in zip(snakemake.params.draw, snakemake.output, strict=True):
        module, _, name = draw.partition(".")
        function = getattr(import_module(f"workflow.report.figures.{module}"), name)
        style.save(function(data, **{key: snakemake.params[key] for key in arguments}), Path(file))
