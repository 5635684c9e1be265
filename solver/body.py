"""Kinds of bodies under a punch: what each is given and answers, by capabilities that have names.

A new kind of body is one entry of ``KINDS``, the rule in :func:`kind_of` that tells its cases by their factors, and a
class behind :class:`Body` in ``face/bodies.py``. Nothing else asks which kind a case is: what differs is asked for by
its name here.
"""

from collections.abc import Collection, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Literal, Protocol

from approximation.arrays import Array
from solver.names import (
    BODY,
    CONTACTS,
    FILM_PEAKS,
    FILM_QUANTITIES,
    OF_A_FILM,
    PEAKS,
    POINT_QUANTITIES,
    PROFILES,
    QUANTITIES,
    TABLED,
    Contact,
    Described,
    Loads,
)

#: What depths and potentials refer to: a datum, nothing but themselves, or either, as base and interface decide.
Datum = Literal["relative", "absolute", "by_base"]


@dataclass(frozen=True)
class Kind:
    """A kind of body, and how a punch touches it.

    Attributes
    ----------
    name
        As titles call it.
    contact
        Whether a contact is a line, per metre of which loads are given, or a point.
    datum
        What its depths and potentials refer to.
    quantities, peaks
        Quantities that its cases may have: those that come together, and those that are searched for.
    regions
        Names of ``solver.curves.REGIONS`` that its peaks may follow from.
    layered
        Whether it has a top layer with a thickness, on a base.
    factors
        Factors that no other kind has.
    tabled
        Numeric factors for whose every value the solver makes tables; empty for a closed form.
    method
        What a solution's source says of it beside the closed form.
    """

    name: str
    contact: Contact
    datum: Datum
    quantities: Mapping[str, Described]
    peaks: Mapping[str, Described]
    regions: tuple[str, ...]
    layered: bool = False
    factors: tuple[str, ...] = ()
    tabled: tuple[str, ...] = ()
    method: str = ""

    @property
    def loads(self) -> Loads:
        """The factors that press and charge its punch; their units are those of ``solver.names.FACTORS``."""
        return CONTACTS[self.contact]

    @property
    def every_quantity(self) -> dict[str, Described]:
        """Quantities with unit and meaning, those with that are searched for."""
        return {**self.quantities, **self.peaks}


HALF_PLANE = Kind("half-plane", "line", "relative", QUANTITIES, PEAKS, ("body",))
FILM = Kind(
    "film",
    "line",
    "by_base",
    QUANTITIES | FILM_QUANTITIES,
    FILM_PEAKS,
    ("interface", "film", "base"),
    layered=True,
    factors=OF_A_FILM,
    tabled=TABLED,
    method="; on films, integral equations with the closed form as their singular part",
)

HALF_SPACE = Kind("half-space", "point", "absolute", POINT_QUANTITIES, {}, ())
POINT_FILM = Kind(
    "film under a point",
    "point",
    "absolute",
    POINT_QUANTITIES | {"nominal_field": FILM_QUANTITIES["nominal_field"]},
    {},
    (),
    layered=True,
    factors=OF_A_FILM,
    tabled=tuple(name for name in TABLED if name not in ("friction", "speed")),
    method="; on films under a point, Galerkin's equations in Legendre functions beside the closed form",
)

#: Kinds by contact and by whether the body is layered.
KINDS: dict[tuple[Contact, bool], Kind] = {
    (kind.contact, kind.layered): kind for kind in (HALF_PLANE, FILM, HALF_SPACE, POINT_FILM)
}


def kind_of(factors: Collection[str], profile: object = "cylinder") -> Kind:
    """The kind of a case.

    Parameters
    ----------
    factors
        Names of the factors that it has.
    profile
        That of its punch; one of one's own, or one that is not known and refused later, is pressed along a line.
    """
    contact = PROFILES[profile].contact if isinstance(profile, str) and profile in PROFILES else "line"
    return KINDS[contact, BODY in factors or "thickness" in factors]


class Body(Protocol):
    """Cases of one kind, solved: arrays by the names of ``solver.names`` over the axes of the cases, then own axes."""

    @property
    def hollow(self) -> bool:
        """Whether the body has places without fields, which are NaN."""

    def quantities(self) -> dict[str, Array]:
        """Quantities that come together and that every case has; (...)."""

    def peaks(self, asked: Set[str]) -> dict[str, Array]:
        """Those that are searched for, asked for and that every case has; (...)."""

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Sizes and curves of regions that every case has, see ``solver.curves``; (...) and (..., point)."""

    def surface(self, positions: Array, *, regular: bool) -> dict[str, Array]:
        """Fields on the surface, those that are singular at the edges also in regular form if asked; (..., position).

        Parameters
        ----------
        positions
            X = (x - c)/h; (position,).
        regular
            Also give fields times sqrt|1 - X^2|.
        """

    def interior(self, x: Array, y: Array, asked: Sequence[str] | None) -> dict[str, Array]:
        """Fields inside on the grid of two axes; (..., y, x).

        Parameters
        ----------
        x, y
            In half-widths of the contact, from its middle and the surface.
        asked
            Names of fields; None: all that need no constant which a material lacks.
        """
