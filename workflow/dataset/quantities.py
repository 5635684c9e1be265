"""The quantities of the whole factorial, or of all batches of a cross approximation, from their slabs."""

from collections.abc import Sequence

import xarray as xr

from solver.names import ALL_QUANTITIES
from storage.blocks import STATISTICS
from workflow.dataset import holes
from workflow.study.refusals import REASON, REFUSAL


def gather(slabs: Sequence[xr.Dataset]) -> xr.Dataset:
    """Quantities of the whole factorial from its slabs, without the statistics of each slab."""
    names = [name for name in ALL_QUANTITIES if name in slabs[0]]
    parts = [part[[*names, *(extra for extra in (REFUSAL, REASON) if extra in part)]] for part in slabs]
    whole = holes.joined(parts, str(slabs[0][names[0]].dims[0]))
    for array in whole.data_vars.values():
        array.attrs = {key: value for key, value in array.attrs.items() if key not in STATISTICS}
    if REFUSAL in whole:
        holes.check(whole, [str(dim) for dim in whole[REFUSAL].dims if whole[dim].dtype.kind == "f"])
    return whole
