"""A world of five inputs that three groups tell, its cases over these groups, and at random in the box."""

from functools import cache

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate import Group, GroupedGP, Grouping, Input, Scaling
from surrogate.transforms.groups import span
from tests.surrogate import functions

INPUTS = (
    Input("mixture", 0.05, 0.9),
    Input("thickness", 1e-4, 1e-3, "log", "m"),
    Input("radius", 0.02, 0.1, "log", "m"),
    Input("load", 1e4, 1e5, "log", "N m-1"),
    Input("charge", -2e-6, 1e-6, "linear", "C m-1"),
)
MIDDLE = {axis.name: float(axis.from_unit(0.0)) for axis in INPUTS}
PRESSING = {"load": 1.0, "radius": 1.0, "thickness": -2.0}
GROUPS = (
    Group(Input("mixture", 0.05, 0.9, "logit"), {"mixture": 1.0}),
    Group(Input("pressing", *span(INPUTS, PRESSING), "log", "Pa"), PRESSING),
    Group(Input("charge_per_load", *span(INPUTS, {"charge": 1, "load": -1})), {"charge": 1.0, "load": -1.0}),
)
SCALINGS = {
    "length": Scaling({"thickness": 1.0}, logarithm=1),
    "cold": Scaling({"thickness": 1.0}, logarithm=-1),
    "voltage": Scaling({"load": 1.0}),
    "depth": Scaling({"load": 1.0}, coefficient=0.3 * MIDDLE["load"]),
    "intensity": Scaling({"load": 1.0, "thickness": -0.5}),
}
GROUPING = Grouping(INPUTS, GROUPS, SCALINGS, added={"thickness": -1.0})
COUNTS = (12, 12, 8)


def world(x: xr.Dataset, rough: float = 0.0) -> xr.Dataset:
    """Outputs that scale: products of powers times functions of the groups, of low degree unless rough."""
    load, thickness = x["load"], x["thickness"]
    z, g = np.log(x.mixture / (1 - x.mixture)), np.log(load * x.radius / thickness**2) / 10
    tau = 1e10 * x.charge / load
    bend = rough / (1.5 + np.sin(z + 2 * g))
    return xr.Dataset(
        {
            "length": thickness * np.exp(0.3 * g - 0.01 * z**2 + bend),
            "cold": -thickness * np.exp(0.1 * g * z + bend),
            "voltage": load * (g * z - tau * (1 + z) + 0.1 * tau**2 + bend),
            "depth": load * (1 + g**2 + tau * z + bend + 0.3 * np.log(MIDDLE["thickness"] / thickness)),
            "intensity": load * thickness**-0.5 * (g**3 - z**3 + bend),
        }
    )


def factorial(rough: float = 0.0) -> xr.Dataset:
    """Cases over the axes: thickness and radius in the middle, load and charge as the groups want them."""
    axes = functions.grid([group.axis for group in GROUPS], COUNTS).coords
    load = axes["pressing"] * MIDDLE["thickness"] ** 2 / MIDDLE["radius"]
    fixed = {"thickness": MIDDLE["thickness"], "radius": MIDDLE["radius"], "load": load}
    x = xr.Dataset(coords={**axes, **fixed, "charge": axes["charge_per_load"] * load})
    return world(x, rough).assign_coords(x.coords)


def cases(count: int, seed: int, rough: float = 0.0, to_ends: int = 0) -> xr.Dataset:
    """Cases spread evenly, and so many more that are drawn towards the ends of the box."""
    random = np.random.default_rng(seed)
    unit = random.uniform(-1, 1, (len(INPUTS), count))
    if to_ends:
        even = np.repeat([1, 0], [count, to_ends])
        unit = np.concatenate([unit, 2 * random.beta(0.3, 0.3, (len(INPUTS), to_ends)) - 1], axis=1)
        return _cases(unit, rough).assign(evenly_drawn=("case", even))
    return _cases(unit, rough)


@cache
def calibrated() -> GroupedGP:
    """Model with logarithms, an added logarithm, a logit axis, a correction, and an outer guard."""
    return GroupedGP(GROUPING).fit(factorial(0.2)).calibrate(cases(300, 11, 0.2, to_ends=300))


def _cases(unit: Array, rough: float) -> xr.Dataset:
    x = xr.Dataset({input_.name: ("case", input_.from_unit(row)) for input_, row in zip(INPUTS, unit, strict=True)})
    return x.merge(world(x, rough))
