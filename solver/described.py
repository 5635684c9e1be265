"""Meaning of names: a factor with its bounds, an output with its unit, a profile with its factors."""

from dataclasses import dataclass
from typing import Literal

_DATUM = (
    "depends on the datum, an arbitrary length: displacements and potentials of a half-plane are logarithmic, and 0 on "
    "its surface at this distance from the contact"
)

#: How a punch touches a body: along a line, per metre of which loads are given, or at a point.
Contact = Literal["line", "point"]


@dataclass(frozen=True)
class Factor:
    """A numeric input of a case: unit, meaning, default (None: must be given) and bounds.

    A case may be without an optional one: it is then NaN, or absent.
    """

    units: str
    long_name: str
    default: float | None = None
    low: float = float("-inf")
    low_allowed: bool = True
    high: float = float("inf")
    high_allowed: bool = True
    optional: bool = False

    @property
    def allowed(self) -> str:
        """Allowed values in words."""
        text = "a finite number"
        if self.low > float("-inf"):
            text += f" {'>=' if self.low_allowed else '>'} {self.low:g}"
        if self.high < float("inf"):
            text += f" and {'<=' if self.high_allowed else '<'} {self.high:g}"
        return f"{text} [{self.units}]"

    def allows(self, value: float) -> bool:
        """Return whether a finite number is within the bounds."""
        above = value >= self.low if self.low_allowed else value > self.low
        return above and (value <= self.high if self.high_allowed else value < self.high)


@dataclass(frozen=True)
class Described:
    """Unit and meaning of an output, and what one must know to use it.

    ``on_datum``: it depends on the datum of a half-plane; ``on_punch``: along a line also on that of an elastic punch.
    ``sparse``: it is NaN in a case that has none.
    ``formula``: how it follows from smoother ones, in the language of designs.
    """

    units: str
    long_name: str
    comment: str = ""
    on_datum: bool = False
    on_punch: bool = False
    sparse: bool = False
    formula: str = ""

    @property
    def attrs(self) -> dict[str, str]:
        """CF attributes."""
        comment = {"comment": self.comment} if self.comment else {}
        return {"units": self.units, "long_name": self.long_name, **comment}


@dataclass(frozen=True)
class Loads:
    """The factors that press and charge a punch: its normal force, and its electric and magnetic charge."""

    force: str
    charges: tuple[str, str]


@dataclass(frozen=True)
class Outline:
    """Required and optional factors of a punch's profile, and the kind of contact it makes."""

    needs: tuple[str, ...]
    may: tuple[str, ...] = ()
    contact: Contact = "line"
    space: bool = False  # Whether it has no axis of revolution: a contact in space

    @property
    def takes(self) -> tuple[str, ...]:
        """Every factor that it has."""
        return (*self.needs, *self.may)


def positive(units: str, long_name: str, default: float | None = None, *, optional: bool = False) -> Factor:
    """A factor that is > 0."""
    return Factor(units, long_name, default, 0.0, low_allowed=False, optional=optional)


def poisson(body: str) -> Factor:
    """Poisson's ratio of a body that a case may be without."""
    long_name = f"Poisson's ratio of {body}"
    return Factor("1", long_name, None, -1.0, low_allowed=False, high=0.5, high_allowed=False, optional=True)


def on_datum(units: str, long_name: str, *, on_punch: bool = False) -> Described:
    """An output that depends on the datum of a half-plane."""
    return Described(units, long_name, _DATUM, on_datum=True, on_punch=on_punch)
