"""Rule figure_effect: the effect of one factor on the surface fields."""

from pathlib import Path

from storage.netcdf import read_whole
from workflow.report.figures import field_panels, style
from workflow.run import joblog
from workflow.study import coupling

snakemake = joblog.start(globals())
data = coupling.kept(read_whole(Path(snakemake.input[0])), snakemake.params.felt)
style.save(field_panels.effect(data), Path(snakemake.output[0]))
