"""Rule sweeps: the effects of the baseline's factors in one file."""

from storage.netcdf import read_whole, write_whole
from workflow.dataset.effects import together
from workflow.run import joblog

snakemake = joblog.start(globals())
effects = {name: read_whole(file) for name, file in zip(snakemake.params.factors, snakemake.input, strict=True)}
write_whole(together(effects), snakemake.output[0])
