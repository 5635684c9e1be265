"""Curves whose largest values are peaks: fields on Chebyshev panels of regions, and the rule of each peak.

A peak has a kink where the position of the largest stress jumps, while the stresses over a region tied to the contact
are smooth in every factor. A peak is the largest value of a measure of the fields, or another field at that point.
"""

from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array
from approximation.measure import Measure
from approximation.panels import Panels, line
from solver.described import Described
from solver.fields import STRESSES


@dataclass(frozen=True)
class Region:
    """Panels of Chebyshev points over a region, row by row of panels and row by row within each, and their fields."""

    fields: tuple[str, ...]  # Names, with the prefix ``<region>_`` in outputs
    # Number of points of each panel from the leading to the trailing side, and ends of the panels
    across: tuple[int, ...]
    across_at: tuple[float, ...]
    # Number of points and ends of each row of panels; of an interface one point
    down: tuple[int, ...] = (1,)
    down_at: tuple[float, ...] = (0.0, 0.0)
    size: str = "mean_pressure"  # Scale of the stresses

    @property
    def panels(self) -> Panels:
        """Numbers of points of the panels."""
        return Panels(self.across, self.down)

    @property
    def stresses(self) -> tuple[str, ...]:
        """Names of the fields that are stresses."""
        return tuple(name for name in self.fields if name.startswith("stress_"))

    @property
    def sizes(self) -> tuple[str, ...]:
        """Name of each field's scale from case to case; empty if it has none."""
        special = {"position": "", "depth": "half_length"}
        return tuple(special.get(field, self.size) for field in self.fields)

    def lines(self) -> tuple[Array, Array]:
        """Coordinates of all points across and down; (across,) and (down,)."""
        return line(self.across, self.across_at), line(self.down, self.down_at)


@dataclass(frozen=True)
class Peak:
    """Rule for a quantity from the curves of a region."""

    region: str  # Name in ``REGIONS``
    measure: Measure  # Measure of the first fields of the region whose largest value is searched
    place: str = ""  # Field that is read at its maximum; empty: the measure itself


_HALF = 0.5**0.5

#: Von Mises stress of (sigma_xx, sigma_yy, sigma_xy, sigma_zz) in plane strain.
VON_MISES = Measure(
    np.zeros((1, 4)),
    np.array([[[_HALF, -_HALF, 0, 0], [0, _HALF, 0, -_HALF], [-_HALF, 0, 0, _HALF], [0, 0, 3.0**0.5, 0]]]),
)
#: Largest principal stress, 0 where none is tensile.
TENSION = Measure(
    np.array([[0.5, 0.5, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0]]),
    np.array([[[0.5, -0.5, 0, 0], [0, 0, 1, 0]], np.zeros((2, 4)), np.zeros((2, 4))]),
)
#: Largest principal stress, negative where none is tensile.
PRINCIPAL = Measure(TENSION.linear[:2], TENSION.root[:2])
#: Size of the shear stress, and tension or 0, of (sigma_xy, sigma_yy).
SHEAR = Measure(np.zeros((1, 2)), np.array([[[1.0, 0.0]]]))
PULL = Measure(np.array([[0.0, 1.0], [0.0, 0.0]]), np.zeros((2, 1, 2)))

_BODY = (-2.0, -1.5, -1.2, -1.0, -0.8, -0.5, 0.5, 0.8, 1.0, 1.2, 1.5, 2.0)
# narrow at the edges, since tension a tenth of the contact below these is as narrow; 1 to 3 is next to an edge, 3 to 5
# up to eight half-lengths and thicknesses from it (solver/line/stressnets.py)
_FILM = (-5.0, -4.0, -3.0, -2.0, -1.0, -0.75, -0.4, 0.4, 0.75, 1.0, 2.0, 3.0, 4.0, 5.0)
_ACROSS = (10, 10, 10, 11, 11, 11, 14, 11, 11, 11, 10, 10, 10)

#: Regions by name: the half-plane, the lowest interface, the film and its base.
REGIONS: dict[str, Region] = {
    "body": Region((*STRESSES, "depth"), (8, 9, 11, 11, 9, 13, 9, 11, 11, 9, 8), _BODY, (9, 9), (0.0, 0.5, 1.0)),
    "interface": Region(
        ("stress_xy", "stress_yy", "position"),
        (24, 24, 40, 24, 24),
        (-5.0, -3.0, -1.0, 1.0, 3.0, 5.0),
        size="load_over_thickness",
    ),
    "film": Region(STRESSES, _ACROSS, _FILM, (10, 9), (-1.0, 0.0, 1.0)),
    "base": Region(STRESSES, _ACROSS, _FILM, (10, 9), (-1.0, 0.0, 1.0)),
}

#: Rule of each peak.
FOLLOWS: dict[str, Peak] = {
    "peak_von_mises": Peak("body", VON_MISES),
    "peak_von_mises_depth": Peak("body", VON_MISES, "depth"),
    "peak_principal_tension": Peak("body", TENSION),
    "interface_shear": Peak("interface", SHEAR),
    "interface_shear_position": Peak("interface", SHEAR, "position"),
    "interface_tension": Peak("interface", PULL),
    "film_peak_von_mises": Peak("film", VON_MISES),
    "film_peak_principal_tension": Peak("film", TENSION),
    "base_peak_von_mises": Peak("base", VON_MISES),
    "base_peak_principal_tension": Peak("base", TENSION),
}

#: Unit and meaning of the fields of any region.
FIELDS: dict[str, Described] = {
    **{name: Described("Pa", f"sigma_{name[-2:]} at the points of the panels") for name in STRESSES},
    "depth": Described("m", "depth of the points"),
    "position": Described("1", "position X = (x - c)/h of the points"),
}

#: Sizes of a case, smooth and positive, that scale fields.
SIZES: dict[str, Described] = {
    "mean_pressure": Described("Pa", "load over the width of the contact"),
    "half_length": Described("m", "half the width of the contact, h"),
    "load_over_thickness": Described("Pa", "load over the thickness of the film"),
}


def described(region: str) -> dict[str, Described]:
    """Unit and meaning of the variables of a region, by name ``<region>_<field>``."""
    return {f"{region}_{field}": FIELDS[field] for field in REGIONS[region].fields}
