"""Materials, refusals, and comparisons with the 50-digit oracle."""

import re
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.arrays import Array
from verification.oracles.precise import Solution
from workflow.run.provenance import ROOT

BTO, CFO, PZT, STEEL, SILICON = (solver.find(name) for name in ("BaTiO3", "CoFe2O4", "PZT-4", "steel", "silicon"))
FIBROUS = solver.fibrous(BTO, CFO, 0.5)
#: Materials that contacts along a line take.
AXIAL = [name for name, material in solver.materials().items() if material.axial]


def without(case: dict[str, Any], *names: str) -> dict[str, Any]:
    """A case without some of its factors and without those that are None."""
    return {name: value for name, value in case.items() if name not in names and value is not None}


_ZERO = 1e-70  # what the oracle's 100 digits leave of a zero


def tables(page: str) -> list[list[str]]:
    """Cells of all tables of a page of docs/, row by row."""
    text = (ROOT / f"docs/{page}.md").read_text(encoding="utf-8")
    return [[cell.strip() for cell in row.split("|")[1:-1]] for row in re.findall(r"^\|.*\|$", text, re.MULTILINE)]


def free_body(material: solver.Material, coupling: str = "e") -> tuple[Array, Array]:
    """Compliance of normal stresses (3, 3) and strain constants (3,), d = s e, by a matrix that is inverted here."""
    m = material
    stiffness = np.array([[m.c11, m.c12, m.c13], [m.c12, m.c11, m.c13], [m.c13, m.c13, m.c33]], dtype=float)
    s = np.linalg.inv(stiffness)
    return s, s @ np.array([getattr(m, f"{coupling}{place}") for place in ("31", "31", "33")], dtype=float)


def assert_agrees(computed: xr.Dataset, exact: Solution, rtol: float = 1e-11) -> None:
    """Every quantity and field of the oracle, each value to ``rtol`` of itself."""
    for name, value in exact.quantities.items():
        np.testing.assert_allclose(computed[name].item(), float(value), rtol=rtol, atol=_ZERO, err_msg=name)
    for name, values in exact.fields.items():
        reference = np.array(values, dtype=float)
        if reference.size:
            np.testing.assert_allclose(computed[name].values, reference, rtol=rtol, atol=_ZERO, err_msg=name)


def refused(factors: Any, message: str, *extra: str, positions: Any = None, **options: Any) -> None:
    """One line that begins so, and has the other words too."""
    with pytest.raises((solver.FactorError, solver.MaterialError)) as caught:
        solver.solve(factors, positions, **options)
    line = str(caught.value)
    assert line.startswith(message), line
    assert all(word in line for word in extra), line
    assert "\n" not in line


def assert_alike(computed: xr.Dataset, expected: xr.Dataset, share: float, names: Iterable[str] | None = None) -> None:
    """Every variable of the second, or those named, in the first: each to a share of its largest value."""
    for name in map(str, expected.data_vars) if names is None else names:
        first, two = computed[name].squeeze().values, expected[name].squeeze().values
        largest = float(np.nanmax(np.abs(two))) if two.size else 0.0
        np.testing.assert_allclose(first, two, rtol=0, atol=share * largest, err_msg=name)
