"""Kinds of bodies under a punch: factors, quantities and properties of each.

A new kind of body is one entry of ``KINDS``, a rule in :func:`kind_of` that recognises its cases by their factors, and
a class in ``face/solution.py``. Other code asks for the properties here, never for the kind itself.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal

from solver import names
from solver.described import Contact, Described, Loads
from solver.fields import FIELDS, POINT_FIELDS
from solver.material.constants import Material, MaterialError
from solver.material.library import find, materials
from solver.stack.layers import Stack

#: Depths and potentials are relative to a datum, absolute, or either, depending on base and interface.
Datum = Literal["relative", "absolute", "by_base"]


#: Profiles with a narrow gap beside the contact: one that ends with the punch, and one that ends at a factor.
_ENDED, _ENDLESS, _END = ("cylinder", "sphere"), ("cone", "power"), "gap_radius"


@dataclass(frozen=True)
class Kind:
    """A kind of body and of its contact with a punch."""

    name: str  # As titles call it
    contact: Contact  # Along a line, whose loads are per metre, or at a point
    datum: Datum  # Reference of depths and potentials
    # Quantities that its cases may have: those solved together, and those that are searched for
    quantities: dict[str, Described]
    peaks: dict[str, Described]
    regions: tuple[str, ...]  # Names of ``solver.curves.REGIONS`` whose curves may give its peaks
    space: bool = False  # Whether its contact has no axis of revolution: a point contact whose surface is a map
    layered: bool = False  # Whether it has a top layer with a thickness, on a base
    air: bool = False  # Whether the air beside its contact carries charge
    factors: tuple[str, ...] = ()  # Factors that no other kind has
    tabled: tuple[str, ...] = ()  # Numeric factors whose every value has its own tables; empty for a closed form
    method: str = ""  # Addition to the method in a solution's source

    @property
    def touch(self) -> "Touch":
        """Contact along a line, at a point of revolution, or in space."""
        return "space" if self.space else self.contact

    @property
    def loads(self) -> Loads:
        """Factors of the force and the charges of the punch."""
        return names.CONTACTS[self.contact]

    @property
    def ends(self) -> tuple[str, str]:
        """Quantities of the contact's extent to the trailing and to the leading side."""
        return ("contact_length_x", "contact_length_x") if self.space else names.ENDS[self.contact]

    def extents(self, solved: Mapping[str, Any]) -> tuple[Any, Any]:
        """Extents of a contact to the trailing and to the leading side [m], in space half of its length."""
        factor = 0.5 if self.space else 1.0
        trailing, leading = self.ends
        return factor * solved[trailing], factor * solved[leading]

    @property
    def fields(self) -> Mapping[str, Described]:
        """Fields on the surface."""
        if self.space:
            return {name: POINT_FIELDS[name] for name in ("contact_pressure", "electric_displacement")}
        return FIELDS if self.contact == "line" else POINT_FIELDS

    @property
    def unbounded(self) -> str:
        """Name of a body without layers."""
        return "half-space" if self.contact == "point" else "half-plane"

    @property
    def every_quantity(self) -> dict[str, Described]:
        """Quantities with unit and meaning, including those that are searched for."""
        return {**self.quantities, **self.peaks}


_NOMINAL_FIELD = {"nominal_field": names.FILM_QUANTITIES["nominal_field"]}
_HEAT_OF_LINES, _HEAT_OF_POINTS = (
    {name: quantity for name, quantity in names.HEAT_QUANTITIES.items() if name != other}
    for other in ("heat_charge", "heat_charge_per_length")
)
HALF_PLANE = Kind("half-plane", "line", "relative", names.QUANTITIES, names.PEAKS, ("body",))
FILM = Kind(
    "film",
    "line",
    "by_base",
    names.QUANTITIES | names.FILM_QUANTITIES | names.ELECTRODE_QUANTITIES | _HEAT_OF_LINES,
    names.FILM_PEAKS,
    ("interface", "film", "base"),
    layered=True,
    factors=(*names.OF_A_FILM, *names.OF_AN_ELECTRODE, *names.OF_HEAT),
    tabled=names.TABLED,
    method="; on films, integral equations with the closed form as their singular part",
)

_OF_A_LINE = {name: quantity for name, quantity in names.QUANTITIES.items() if "_edge_intensity_" not in name}
_IN_AIR = "; with air beside the contact, Newton's iteration on charges beside it"
HALF_PLANE_IN_AIR = Kind(
    "half-plane with air beside the contact",
    "line",
    "relative",
    _OF_A_LINE
    | {name: names.FILM_QUANTITIES[name] for name in ("capacitance_per_length", "permeance_per_length")}
    | names.GAP_QUANTITIES,
    names.PEAKS,
    ("body",),
    air=True,
    tabled=tuple(name for name in names.TABLED if name not in names.OF_A_FILM),
    method=_IN_AIR,
)
FILM_IN_AIR = replace(
    FILM,
    name="film with air beside the contact",
    quantities=_OF_A_LINE | names.FILM_QUANTITIES | names.GAP_QUANTITIES | _HEAT_OF_LINES,
    air=True,
    method=FILM.method + _IN_AIR,
)

HALF_SPACE = Kind("half-space", "point", "absolute", names.POINT_QUANTITIES | names.POINT_SLIDING, names.PEAKS, ())
POINT_FILM = Kind(
    "film under a point",
    "point",
    "absolute",
    HALF_SPACE.quantities | _NOMINAL_FIELD | names.ELECTRODE_QUANTITIES | _HEAT_OF_POINTS,
    names.FILM_PEAKS,
    (),
    layered=True,
    factors=(*names.OF_A_FILM, *names.OF_AN_ELECTRODE, *names.OF_HEAT),
    tabled=tuple(name for name in names.TABLED if name not in ("friction", "speed")),
    method="; on films under a point, Galerkin's equations in Legendre functions beside the closed form",
)

_OF_A_POINT = {name: quantity for name, quantity in HALF_SPACE.quantities.items() if "_edge_intensity" not in name}
HALF_SPACE_IN_AIR = replace(
    HALF_SPACE,
    name="half-space with air beside the contact",
    quantities=_OF_A_POINT | names.POINT_GAP_QUANTITIES,
    air=True,
    tabled=tuple(name for name in POINT_FILM.tabled if name not in names.OF_A_FILM),
    method=_IN_AIR,
)
POINT_FILM_IN_AIR = replace(
    POINT_FILM,
    name="film under a point with air beside it",
    quantities=HALF_SPACE_IN_AIR.quantities | _NOMINAL_FIELD | _HEAT_OF_POINTS,
    air=True,
    method=POINT_FILM.method + _IN_AIR,
)

SPACE = Kind(
    "contact in space",
    "point",
    "absolute",
    names.SPACE_QUANTITIES,
    {},
    (),
    space=True,
    factors=names.OF_SPACE,
    method="; semismooth Newton iteration with kernels of the infinite body",
)
SPACE_IN_AIR = replace(SPACE, name="contact in space, air beside it", air=True)
SPACE_ON_LAYERS, SPACE_ON_LAYERS_IN_AIR = (
    replace(
        kind,
        name=f"{kind.name}, on layers",
        quantities=kind.quantities | _NOMINAL_FIELD,
        layered=True,
        factors=(*names.OF_A_FILM, *names.OF_SPACE),
    )
    for kind in (SPACE, SPACE_IN_AIR)
)

_KINDS = (
    HALF_PLANE, FILM, HALF_PLANE_IN_AIR, FILM_IN_AIR, HALF_SPACE, POINT_FILM, HALF_SPACE_IN_AIR, POINT_FILM_IN_AIR,
    SPACE, SPACE_ON_LAYERS, SPACE_IN_AIR, SPACE_ON_LAYERS_IN_AIR,
)  # fmt: skip
#: Contact along a line, at a point of revolution, or in space.
Touch = Literal["line", "point", "space"]
#: Kinds by contact, by whether the body is layered, and by whether air beside the contact carries charge.
KINDS: dict[tuple[Touch, bool, bool], Kind] = {(kind.touch, kind.layered, kind.air): kind for kind in _KINDS}


def kind_of(
    factors: Collection[str],
    profile: object = "cylinder",
    surroundings: object = names.CHOICES["surroundings"][0],
    materials: Iterable[object] = (),
) -> Kind:
    """Return the kind of a case; on a cut (by factor or material) a sphere, cone or disc is a contact in space."""
    outline = names.PROFILES[profile if isinstance(profile, str) and profile in names.PROFILES else "cylinder"]
    space = outline.space or (profile in names.ON_CUTS and ("cut" in factors or any(map(is_cut, materials))))
    layered = names.BODY in factors or "thickness" in factors
    return KINDS["space" if space else outline.contact, layered, surroundings == names.AIR]


def solids(case: Mapping[str, object]) -> list[object]:
    """Return material, base and stack of a case, as far as its factors name them."""
    return [case[name] for name in ("material", "base", names.BODY) if name in case]


def is_cut(material: object) -> bool:
    """Return whether a material, its built-in name or a stack is a crystal for contacts in space alone."""
    if isinstance(material, Stack):
        base = [] if isinstance(material.base, str) else [material.base]
        return any(map(is_cut, [*(layer.material for layer in material.layers), *base]))
    return not material.axial if isinstance(material, Material) else isinstance(material, str) and _named_cut(material)


@cache
def _named_cut(name: str) -> bool:
    """Return whether a built-in material is a crystal for contacts in space alone."""
    try:
        return not find(name).axial
    except MaterialError:
        return False  # one of the user's, or refused when the material is looked up


def airless(case: Mapping[str, object]) -> str:
    """Return the reason why a case, by its factors, cannot have air beside its contact; empty if it can."""

    def choice(name: str) -> object:
        return case.get(name, names.CHOICES[name][0])

    if choice("magnetic") == "insulating" and (choice("electric") == "insulating" or _metallic(case)):
        return "the punch conducts no field, so that no charge lies beside it"
    if choice("electrode") != names.CHOICES["electrode"][0]:
        return "the electrode on its film lies below the punch"
    if ({*names.OF_AN_ELECTRODE} - {"electrode"}) & case.keys():
        return "what an electrode of its film collects is not solved with air"
    profile = choice("profile")
    is_smooth = not isinstance(profile, str) and all(getattr(profile, "smooth", (False,)))  # a profile of the user
    if not is_smooth and profile not in _ENDED and not (profile in _ENDLESS and _END in case):
        return f"no narrow gap with an end lies beside its punch ({profile})"
    body = case.get(names.BODY)
    stack = body if isinstance(body, Stack) else None
    sideways = choice("interface_magnetic") == "insulated" or (stack and stack.insulated)
    if sideways and choice("magnetic") == "conducting":
        return "flux leaves its film sideways without end, for its base is magnetically insulated"
    return ""


def _metallic(case: Mapping[str, object]) -> bool:
    """Return whether a film is a metal, which does not share the punch's potential."""
    body, material = case.get(names.BODY), case.get("material")
    if isinstance(body, Stack):
        return body.conductors[0]
    known = material if isinstance(material, Material) else materials().get(str(material))
    return "thickness" in case and known is not None and bool(known.conductor)


def around(case: Mapping[str, object]) -> str:
    """Return the default surroundings of a case: air in space and on films where possible, else insulated."""
    kind = kind_of(case, case.get("profile", "cylinder"), materials=solids(case))
    if kind.space:
        return names.AIR
    return names.AIR if kind.layered and not airless(case) else names.CHOICES["surroundings"][0]
