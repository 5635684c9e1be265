"""Packed cores give the means back to 1e-9 of their range, in a fraction of the bytes."""

import base64
from typing import Any

import numpy as np
import pytest
import xarray as xr
from xarray import ufuncs

from approximation.arrays import Array
from surrogate import GridGP, Input
from surrogate.use.export import exported


def plain(stored: dict[str, Any]) -> Array:
    """An array as :func:`surrogate.data.packing.array` stores it."""
    return np.frombuffer(base64.b64decode(stored["data"]), "<f8").reshape(stored["shape"])


def unpacked(stored: dict[str, Any]) -> Array:
    """A core from its bytes, one number after the other."""
    numbers, value, size = [], 0, 1
    for byte in base64.b64decode(stored["data"]):
        value, size = value + (byte & 127) * size, size * 128
        if byte < 128:
            numbers.append(-(value + 1) // 2 if value % 2 else value // 2)
            value, size = 0, 1
    whole = np.array(numbers, dtype=np.float64).reshape(stored["shape"])
    return whole * plain(stored["rows"])[:, None, None] * plain(stored["columns"])


@pytest.fixture(scope="module")
def model() -> GridGP:
    inputs = [
        Input("a", -1, 1, "linear", "1", "a"),
        Input("b", 1, 10, "log", "1", "b"),
        Input("c", 0, 2, "linear", "1", "c"),
    ]
    a, b, c = (
        xr.DataArray(input_.levels(n), dims=input_.name, coords={input_.name: input_.levels(n)})
        for input_, n in zip(inputs, (14, 9, 8), strict=True)
    )
    bent, small = ufuncs.tanh(3 * a * c) + 1e6 * ufuncs.log(b), 1e-9 * ufuncs.exp(a * b / 10) * ufuncs.cos(c)
    values = {"bent": bent, "small": small}
    data = xr.Dataset(
        {name: input_.transpose("a", "b", "c").assign_attrs(units="1") for name, input_ in values.items()}
    )
    return GridGP(inputs, list(map(str, data))).fit(data)


def test_means_from_packed_cores_are_those_of_the_model(model: GridGP) -> None:
    stored = exported(model)
    assert stored is not None
    cores = [unpacked(core_data) for core_data in stored["cores"]]
    t = np.random.default_rng(1).uniform(-1, 1, (500, 3))
    state = np.ones((500, 1))
    for k, core in zip(stored["order"], cores, strict=True):
        feature = model.factors_[k].features(t[:, k], core.shape[1]).mean
        state = np.einsum("ni,imj,mn->nj", state, core, feature)
    unpacked_means = state * plain(stored["scale"]) + plain(stored["offset"])
    points = np.stack([core_data.from_unit(t[:, k]) for k, core_data in enumerate(model.inputs_)], axis=-1)
    exact = model.predict_array(points)
    assert np.abs((unpacked_means - exact) / np.ptp(exact, axis=0)).max() < 1e-10
    assert sum(len(core_data["data"]) for core_data in stored["cores"]) < 0.6 * sum(
        core.size * 8 * 4 / 3 for core in cores
    )
