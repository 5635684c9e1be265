"""Rule figure_fields: surface fields of some cases of the data set."""

from contextlib import ExitStack
from pathlib import Path

from storage.netcdf import read_whole
from workflow.report.figures import field_panels, style
from workflow.run import joblog
from workflow.study import coupling

snakemake = joblog.start(globals())
with ExitStack() as stack:
    slabs = [stack.enter_context(read_whole(Path(file), lazy=True)) for file in snakemake.input]
    style.save(
        field_panels.fields([coupling.kept(slab, snakemake.params.felt) for slab in slabs]), Path(snakemake.output[0])
    )
