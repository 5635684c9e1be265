"""Rule surface: the surface fields under the punch as a surrogate, and its errors on exact cases."""

from pathlib import Path

from storage.netcdf import write_whole
from surrogate import save
from workflow.dataset import levels
from workflow.learning import surface
from workflow.study import planned

snakemake, config = planned.start(globals())
config = levels.with_levels(config, snakemake.input.levels)
model = surface.fit(config)
save(model, Path(snakemake.output.model))
write_whole(surface.validate(config, model), snakemake.output.validation)
