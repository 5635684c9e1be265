"""Descriptions of factors with their bounds, of outputs with their units, and of profiles with their factors."""

from dataclasses import dataclass
from typing import Literal

_DATUM = (
    "depends on the datum, an arbitrary length: displacements and potentials of a half-plane are logarithmic, and 0 on "
    "its surface at this distance from the contact"
)

#: Contact along a line, whose loads are per metre, or at a point.
Contact = Literal["line", "point"]


@dataclass(frozen=True)
class Factor:
    """A numeric input of a case with unit, meaning, default and bounds."""

    units: str
    long_name: str
    default: float | None = None  # None: the factor must be given
    low: float = float("-inf")
    low_allowed: bool = True
    high: float = float("inf")
    high_allowed: bool = True
    optional: bool = False  # Whether cases may lack it, as NaN or by its absence

    @property
    def allowed(self) -> str:
        """Words for the allowed values, with their unit."""
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
    """Unit and meaning of an output, and conditions on its use."""

    units: str
    long_name: str
    comment: str = ""
    on_datum: bool = False  # Whether it depends on the datum of a half-plane
    on_punch: bool = False  # Whether it depends along a line on the datum of an elastic punch, too
    sparse: bool = False  # Whether it is NaN in cases that have none
    formula: str = ""  # Its value from smoother outputs, in the language of designs

    @property
    def attrs(self) -> dict[str, str]:
        """Attributes by the CF conventions."""
        comment = {"comment": self.comment} if self.comment else {}
        return {"units": self.units, "long_name": self.long_name, **comment}


@dataclass(frozen=True)
class Loads:
    """Factors of the normal force on a punch, and of its electric and magnetic charge."""

    force: str
    charges: tuple[str, str]


@dataclass(frozen=True)
class Outline:
    """Factors of a punch's profile, and its kind of contact."""

    needs: tuple[str, ...]  # Required factors
    may: tuple[str, ...] = ()  # Optional factors
    contact: Contact = "line"
    space: bool = False  # Whether it has no axis of revolution: a contact in space

    @property
    def takes(self) -> tuple[str, ...]:
        """Required and optional factors."""
        return (*self.needs, *self.may)


def positive(units: str, long_name: str, default: float | None = None, *, optional: bool = False) -> Factor:
    """Return a factor that is > 0."""
    return Factor(units, long_name, default, 0.0, low_allowed=False, optional=optional)


def poisson(body: str) -> Factor:
    """Return the factor of Poisson's ratio of an optional body."""
    long_name = f"Poisson's ratio of {body}"
    return Factor("1", long_name, None, -1.0, low_allowed=False, high=0.5, high_allowed=False, optional=True)


def on_datum(units: str, long_name: str, *, on_punch: bool = False) -> Described:
    """Return an output that depends on the datum of a half-plane."""
    return Described(units, long_name, _DATUM, on_datum=True, on_punch=on_punch)
