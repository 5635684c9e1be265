"""The datum of a study: the arbitrary length of a half-plane's logarithmic potentials, and what hangs on it."""

from collections.abc import Callable, Mapping
from typing import Any, Protocol

import numpy as np
import xarray as xr

from solver import solve
from solver.names import ALL_QUANTITIES, FACTORS
from workflow.study.sections import Axis


class Physics(Protocol):
    """What of a study decides what its cases are."""

    @property
    def fixed(self) -> dict[str, float | str]:
        """Factors with one value."""

    @property
    def factors(self) -> dict[str, Axis]:
        """The box."""

    @property
    def categories(self) -> dict[str, list[str]]:
        """Names of every category."""

    @property
    def on_film(self) -> bool:
        """Whether the cases are films."""

    @property
    def tabled(self) -> list[str]:
        """Factors for whose every value the solver makes tables of films."""

    def solved(
        self, entrance: Callable[..., xr.Dataset], factors: Mapping[str, Any], *axes: Any, **options: Any
    ) -> xr.Dataset:
        """Exact cases."""


#: Names of the quantities that change with the datum of a half-plane.
HANGING = frozenset(name for name, one in ALL_QUANTITIES.items() if one.on_datum)
_SAME = 1e-9  # relative difference up to which two values are one
_RELATIVE = " relative to the datum"


def length(study: Physics) -> float | None:
    """The datum of every case [m]; None where it is a factor."""
    if "datum" in study.factors:
        return None
    return float(study.fixed.get("datum", FACTORS["datum"].default or 1.0))


def inner(study: Physics, share: float = 0.5) -> dict[str, float]:
    """A point of the box, this far from the lower end of every axis on its own scale; by default its middle."""
    return {
        name: float(
            axis.low ** (1 - share) * axis.high**share
            if axis.scale == "log"
            else (1 - share) * axis.low + share * axis.high
        )
        for name, axis in study.factors.items()
    }


def hanging(study: Physics) -> frozenset[str]:
    """Names of the quantities that change with the datum in some cases of a study.

    What does on a film depends on its base and interface: the solver says so, at a point where no charge is likely to
    be 0, and for which a study that was checked has tables.
    """
    if not study.on_film:
        return HANGING
    here = inner(study, 0.7) | {name: study.factors[name].high for name in study.tabled}
    datum = (here.pop("datum", None) or length(study) or 1.0) * np.array([1.0, 10.0])
    fixed = {name: value for name, value in study.fixed.items() if name != "datum"}
    cases = {**fixed, **study.categories, **here, "datum": datum}
    solved = study.solved(solve, cases)
    found = {name: solved[name].transpose("datum", ...).values for name in HANGING if name in solved}
    return frozenset(
        name for name, values in found.items() if np.any(np.abs(np.diff(values, axis=0)) > _SAME * np.abs(values[0]))
    )


def meaning(name: str, hanging: frozenset[str]) -> str:
    """What a quantity is, relative to the datum only where it hangs on it."""
    words = ALL_QUANTITIES[name].long_name
    return words if name in hanging else words.removesuffix(_RELATIVE)
