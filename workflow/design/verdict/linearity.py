"""Limits of linear theory at a design: limits of its materials, and small strain."""

from collections.abc import Mapping

import numpy as np

from approximation.arrays import Array
from solver.face.strain import DEEP, WIDE
from solver.names import ALL_QUANTITIES, LIMITED
from workflow.language import titles
from workflow.language.constants import ALLOWABLES, of_the_base, plain
from workflow.language.numbers import shown
from workflow.language.statements import Limit
from workflow.study.model import Study

_CERAMIC_FIELD = 3e5  # V/m: beyond it ferroelectric ceramics are not linear; for materials without a known field
_FIELDS = ("coercive_field", "breakdown_field")
_MOST_DIGITS = 9
_SMALL = "strains are small only up to there"


def bound(study: Study, limit: Limit) -> tuple[str, str]:
    """Return the allowable and its material in words, and the source; empty where the study gives a number."""
    if not limit.allowable:
        return "", ""
    evidence = study.allowable(limit.allowable)
    return f"{titles.title(limit.allowable)} of {evidence.material}", evidence.source


def beyond(study: Study, corner: Mapping[str, Array], below: float | None = None) -> list[tuple[str, str]]:
    """Return exceeded limits of a design's materials: each in words with both numbers, and its source."""
    lines, knows_field = [], False
    for name, described in ALLOWABLES.items():
        try:
            allowable = study.allowable(name)
        except ValueError:
            continue
        knows_field |= name in _FIELDS
        at_most = f"{titles.title(name)} of {allowable.material}, {shown(allowable.value, described.units, 3)}"
        for quantity in _bounded(name):
            words, size = _largest(quantity, corner, study.kind.ends, below)
            if size > allowable.value:
                value = _above(size, allowable.value, described.units, 3)
                lines.append((f"{words} of {value} exceeds the {at_most}", allowable.source))
    words, size = _largest("nominal_field", corner, study.kind.ends, below)
    if not knows_field and size > _CERAMIC_FIELD:
        usual = f"{shown(_CERAMIC_FIELD, 'V m-1', 3)}, beyond which ferroelectric ceramics are not linear"
        unknown = "the library has no coercive or breakdown field of the material"
        lines.append((f"{words} of {shown(size, 'V m-1', 3)} exceeds {usual}", unknown))
    return lines


def beyond_small_strain(
    study: Study, corner: Mapping[str, Array], radius: Array | None, thickness: Array | None
) -> list[tuple[str, str]]:
    """Return contacts too wide or too deep for small strain, in words with both numbers, and the reason."""
    trailing, leading = study.kind.extents(corner)
    deep = corner["depth"] if "depth" in corner and study.kind.datum == "absolute" else None
    lines = []
    for size, reference, most, name, reference_name in (
        ((trailing + leading) / 2, radius, WIDE, "a contact half-width", "the punch radius"),
        (deep, thickness, DEEP, "a depth", "the film's thickness"),
    ):
        if size is None or reference is None:
            continue
        share = float((size / reference).max())
        if share > most:
            words = f"{name} of {shown(float(size.max()), 'm', 3)} is {_above(share, most)} of {reference_name}"
            lines.append((f"{words} and exceeds {most:g} of it", _SMALL))
    return lines


def _above(size: float, most: float, units: str = "1", digits: int = 2) -> str:
    """Return a size that exceeds a limit, with enough digits to differ from it."""
    while digits < _MOST_DIGITS and shown(size, units, digits) == shown(most, units, digits):
        digits += 1
    return shown(size, units, digits)


def _bounded(name: str) -> list[str]:
    """Return the quantities that an allowable bounds."""
    if not of_the_base(name):
        return list(LIMITED[name])
    of_base = {"tensile_strength": "base_peak_principal_tension", "yield_strength": "base_peak_von_mises"}
    return [of_base[plain(name)]] if plain(name) in of_base else []


def _largest(
    quantity: str, corner: Mapping[str, Array], ends: tuple[str, str], below: float | None
) -> tuple[str, float]:
    """Return a quantity in words, and its largest value; 0 without one, as for an insulating punch's voltage."""
    if quantity in corner:
        return titles.title(quantity), float(corner[quantity].max())
    if quantity == "nominal_field" and below is not None:
        return "electric field below the middle of the contact", below
    if quantity == "nominal_field" and "voltage" in corner:  # no thickness, and no fields inside
        trailing, leading = ends
        width = corner[trailing] + corner[leading]
        return "voltage over the contact's width", float((np.abs(corner["voltage"]) / width).max())
    assert quantity in ALL_QUANTITIES
    return quantity, 0.0
