"""Analytic test functions of five factors, one with a near-pole, and factorials of them."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate import Input
from surrogate.data.inputs import physical_points

INPUTS = (
    Input("mixture", 0.05, 0.95, "linear", "1", "mixture fraction"),
    Input("angle", 0.0, 0.6, "linear", "rad"),
    Input("size", 5e-3, 0.2, "log", "m", "size"),
    Input("force", 3e3, 3e5, "log", "N", "force"),
    Input("bias", -2.0, 2.0, "linear", "V", "bias"),
)


def outputs(x: Mapping[str, xr.DataArray] | xr.Dataset) -> dict[str, xr.DataArray]:
    """Six outputs: a near-pole just outside the box at mixture = 0.02, powers of size and force, affine in bias."""
    pole = 1 / (x["mixture"] - 0.02 - 0.005 * np.sin(x["angle"]))
    work = np.sqrt(x["size"] * x["force"])
    tilt = np.exp(-0.7 * x["angle"]) * (1 + 0.3 * x["mixture"])
    return {
        "near_pole": pole * tilt * np.log(x["force"]) + x["bias"] * pole,
        "smooth": work * tilt,
        "affine": work * np.cos(x["angle"]) + x["bias"] * (3 + x["mixture"] * x["size"] ** 0.25),
        "no_bias": np.sin(3 * x["mixture"] + x["angle"]) * x["force"] ** 0.2,
        "ratio": x["size"] ** -0.3 * (1 + x["mixture"]) / (2 + x["angle"]),
        "mixed": tilt * np.log(x["size"]) * x["force"] ** 0.1 + 0.01 * x["bias"] * work,
    }


def grid(inputs: Sequence[Input], counts: Sequence[int]) -> xr.Dataset:
    """Return the Chebyshev-Gauss levels of inputs as the coordinates of an empty data set."""
    return xr.Dataset(coords={input_.name: input_.levels(n) for input_, n in zip(inputs, counts, strict=True)})


def drawn(inputs: Sequence[Input], count: int, seed: int) -> xr.Dataset:
    """Return inputs over `case`, uniform in the scaled coordinates."""
    unit = np.random.default_rng(seed).uniform(-1, 1, (len(inputs), count))
    return xr.Dataset({input_.name: ("case", input_.from_unit(row)) for input_, row in zip(inputs, unit, strict=True)})


def factorial(counts: Sequence[int], inputs: Sequence[Input] = INPUTS) -> xr.Dataset:
    """Return the outputs on Chebyshev-Gauss levels; an output keeps only the dimensions that it depends on."""
    data = xr.Dataset(outputs(grid(inputs, counts)))
    for name in data.data_vars:
        data[name].attrs |= {"units": "Pa", "long_name": f"the {name} output"}
    return data


def scattered(count: int, seed: int, inputs: Sequence[Input] = INPUTS) -> xr.Dataset:
    """Return inputs, uniform in the scaled coordinates, and outputs over `case`."""
    x = drawn(inputs, count, seed)
    return x.assign(outputs(x))


def true_slopes(points: xr.Dataset, input_: Input) -> tuple[xr.Dataset, dict[str, xr.DataArray]]:
    """Return the points a small step within an input's range, and differences of the outputs along it there."""
    step, values = 1e-5 * (input_.high - input_.low), points[input_.name]
    inner = points.where((values > input_.low + step) & (values < input_.high - step), drop=True)
    columns = {str(name): column for name, column in inner.items()}
    above, below = (outputs({**columns, input_.name: inner[input_.name] + sign * step}) for sign in (1, -1))
    return inner, {name: (above[name] - below[name]) / (2 * step) for name in above}


def inside(inputs: Sequence[Input], count: int, seed: int = 2, reach: float = 0.9) -> Array:
    """Return random points within a share of the box about its middle, (n, d); beyond 1, the ends are among them."""
    t = np.random.default_rng(seed).uniform(-reach, reach, (len(inputs), count)).clip(-1, 1)
    return physical_points(inputs, t)
