"""Rule surface: the surface fields under the punch as a surrogate, and its errors on exact cases."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from storage.netcdf import write_whole
from surrogate import save
from workflow.dataset import levels
from workflow.learning import surface
from workflow.run import joblog
from workflow.study import planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = levels.resolved(planned.study(snakemake.wildcards.study, snakemake.params.study), snakemake.input.levels)
model = surface.fit(config)
save(model, Path(snakemake.output.model))
write_whole(surface.validate(config, model), Path(snakemake.output.validation))
