"""Two hills over a square, the higher one's height and place as outputs."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.chebyshev import gauss_points
from approximation.measure import Measure
from approximation.panels import Panels
from surrogate import CurveGP, GridGP, Group, GroupedGP, Grouping, Input, Scaling
from surrogate.transforms.curves.basis import Curves, Largest
from tests.surrogate import functions

Array = NDArray[np.float64]

INPUTS = (Input("a", -1, 1), Input("b", 0.5, 2, "log"))
PANELS = Panels((12, 10), (8,))
SQUARE = Measure(np.zeros((1, 2)), np.eye(2)[None])  # the norm of both fields
OUTPUTS = ["plain", "top", "place"]
LARGEST = {"top": Largest(0, SQUARE), "place": Largest(0, SQUARE, 2)}
HILLS = Curves(("f", "g", "x"), ("size", "size", ""), PANELS, "point")


def points() -> tuple[Array, Array]:
    """Coordinates over [-1, 1] across, in two panels, and [0, 1] down."""
    down = (1 + gauss_points(8)) / 2
    parts = [np.meshgrid(0.5 * (gauss_points(n) + side), down) for n, side in ((12, -1), (10, 1))]
    across, along = (np.concatenate([part[k].ravel() for part in parts]) for k in (0, 1))
    return across, along


def fields(a: Any, b: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """Two hills, of which one or the other is higher as the sign of a + 0.1 b tells."""
    left = np.exp(-3 * (x + 0.55) ** 2 - (y - 0.3 * b) ** 2)
    right = np.exp(-2 * (x - 0.45 - 0.1 * a) ** 2 - 2 * (y - 0.4) ** 2)
    return b * (left * (1 - 0.3 * a) + right * (1 + 0.3 * a + 0.06 * b)), b * 0.2 * (x + y * a)


def data(a: xr.DataArray, b: xr.DataArray) -> xr.Dataset:
    """The curves of cases, their size, and what is smooth itself."""
    x, y = (xr.DataArray(coordinate, dims="point") for coordinate in points())
    f, g = fields(a, b, x, y)
    like = xr.broadcast(a, b)[0]
    out = {"f": f, "g": g, "x": x.broadcast_like(f), "size": (b + 0 * a), "plain": (np.exp(a) * b)}
    return (
        xr.Dataset(out)
        .assign_coords({n: like[n] for n in like.dims if n in like.coords})
        .drop_vars("point", errors="ignore")
    )


def grid() -> xr.Dataset:
    """The curves on 7 x 9 levels."""
    x = functions.grid(INPUTS, (7, 9))
    return data(x.a, x.b)


def fitted() -> CurveGP:
    return CurveGP(lambda names: GridGP(inputs=INPUTS, outputs=names), [HILLS], LARGEST, OUTPUTS).fit(grid())


def fitted_over_groups() -> CurveGP:
    """The same over groups that are the inputs, sizes and what is plain in proportion to b."""
    groups = tuple(Group(input_, {input_.name: 1.0}) for input_ in INPUTS)

    def smooth(names: Sequence[str]) -> GroupedGP:
        scalings = {name: Scaling({"b": 1.0} if name in ("size", "plain") else {}) for name in names}
        return GroupedGP(Grouping(INPUTS, groups, scalings))

    return CurveGP(smooth, [HILLS], LARGEST, OUTPUTS, logarithms=False).fit(grid())
