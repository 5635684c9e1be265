"""Rules between factors: required factors, factors that exclude each other, and factors of some kinds of body alone."""

import numpy as np

from solver.arrays import shown
from solver.body import KINDS, airless
from solver.described import Contact
from solver.face.factorvalues import IN_SPACE, POINTED, FactorValues, absent, distinct_cases
from solver.face.refusal import FactorError
from solver.halfplane.profile import Profile
from solver.material.constants import Material
from solver.names import (
    AIR,
    ANGLED_CUTS,
    BODY,
    CHOICES,
    COMPOSITES,
    CONTACTS,
    FACTORS,
    HEIGHT_MAP,
    OF_A_FILM,
    OF_A_GAP,
    OF_A_LINE,
    OF_AN_ELECTRODE,
    OF_HEAT,
    OF_SPACE,
    ON_CUTS,
    PROFILES,
)
from solver.stack.layers import RIGID, Stack

_STEEPEST = 1.0  # slope of a cone or wedge beyond which the theory of small slopes is meaningless
#: Factors that only some profiles have.
_OF_SHAPES = tuple(dict.fromkeys(name for outline in PROFILES.values() for name in outline.takes))
_CHARGES = {
    "charge": "electric", "magnetic_charge": "magnetic", "total_charge": "electric", "total_flux": "magnetic",
}  # fmt: skip
_BASE = f"{RIGID!r} or a material's name, or else base_modulus and base_poisson"
#: Factors of electrodes and of heat, and the factor that each requires.
_ELECTRODE_NEEDS = {
    "patch_size": "collector", "patch": "patch_size", "patch_position": "patch_size", "patch_pitch": "patch_size",
}  # fmt: skip
_HEAT_NEEDS = {
    "touch_temperature": "hold", "hold": "touch_temperature", "feedback_resistance": "feedback_capacitance",
}  # fmt: skip


def check(cases: FactorValues) -> None:
    """Check materials, punch, loads and layers, and refuse the first factor at fault."""
    if BODY not in cases.values:
        _check_material(cases)
    _check_profile(cases)
    for charge, field in _CHARGES.items():
        carried = (cases.number(charge) != 0) & cases.among(field, "insulating")
        cases.refuse(charge, carried, f"on a punch that is {field} insulating; must be 0")
    _check_elasticity(cases, "punch")
    _check_space(cases)
    _check_films(cases)


def check_surrounded(cases: FactorValues) -> None:
    """Check the gaps, electrodes and heat of cases with known surroundings."""
    _check_gaps(cases)
    _check_electrodes(cases)
    _check_air(cases)
    _check_heat(cases)


def _missing(name: str, reason: str = "") -> FactorError:
    """Return the error for a missing factor."""
    return FactorError(f"{name}: missing; must be {FACTORS[name].allowed}{reason}")


def _needed(name: str, needed: str) -> FactorError:
    """Return the error for a missing factor that another one requires."""
    return FactorError(f"{needed}: missing; {name} needs it; must be {FACTORS[needed].allowed}")


def _check_material(cases: FactorValues) -> None:
    """Require either a material, or composites with exactly their fractions."""
    values = cases.values
    fractions = [name for name in dict.fromkeys(COMPOSITES.values()) if name in values]
    if "material" in values:
        if fractions or "composite" in values:
            other = fractions[0] if fractions else "volume_fraction"
            raise FactorError(f"material: give either a material or a composite's {other}, not both")
        return
    if "composite" not in values and not fractions:
        raise FactorError("material: missing; give a material's name, or a composite's volume_fraction")
    composites = dict.fromkeys(values["composite"].flat) if "composite" in values else [CHOICES["composite"][0]]
    taken = {COMPOSITES[kind]: kind for kind in composites}
    for name in fractions:
        if name not in taken:
            owners = [kind for kind, fraction in COMPOSITES.items() if fraction == name]
            raise FactorError(f"{name}: the composite {', '.join(composites)} has none; {' or '.join(owners)} has it")
    for name, kind in taken.items():
        if name not in fractions:
            raise _missing(name, f" (composite {kind})")


def _check_profile(cases: FactorValues) -> None:
    """Require the factors of every profile, and refuse those that no profile takes."""
    values = cases.values
    kinds = dict.fromkeys(values["profile"].flat) if "profile" in values else ["cylinder"]
    profiles = [str(kind) for kind in kinds if not isinstance(kind, Profile)]
    takes = {name: PROFILES[name] for name in profiles}
    for profile, outline in takes.items():
        for name in outline.needs:
            if name not in values:
                raise _missing(name, f" (profile {profile})")
    outlines = list(takes.values()) or [PROFILES["cylinder"]]  # a user's profile is pressed along a line
    words = ", ".join(profiles) or "given"
    _check_contacts(cases, {outline.contact for outline in outlines}, words)
    taken = {name for outline in takes.values() for name in outline.takes}
    for name in _OF_SHAPES:
        if name in values and name not in taken:
            raise FactorError(f"{name}: the profile {words} has none")
    if "moment" in values and "slope" in values and "flat" in profiles:
        raise FactorError("moment: give either the slope or the moment of a flat punch, not both")
    for sharp in {"wedge", "cone"} & set(profiles) if "flat" not in profiles else ():
        cases.refuse("slope", values["slope"] <= 0, f"is not a finite number > 0 [1] (profile {sharp})")
        if (steepest := float(np.max(values["slope"]))) > _STEEPEST:
            raise FactorError(
                f"slope: {steepest:g} is {np.degrees(np.arctan(steepest)):.4g} degrees from the surface; must be <= "
                f"{_STEEPEST:g}, 45 degrees: the theory is linear (profile {sharp})"
            )


def _check_contacts(cases: FactorValues, contacts: set[Contact], profiles: str) -> None:
    """Require the force of line and point contacts, and refuse forces and charges of the other kind."""
    values = cases.values
    for contact, loads in CONTACTS.items():
        has_wrong_force = any(wrong.force in values for kind, wrong in CONTACTS.items() if kind not in contacts)
        if contact in contacts and loads.force not in values and not has_wrong_force:
            raise _missing(loads.force)
        if contact in contacts:
            continue
        allowed = CONTACTS[next(iter(contacts))]
        for name, instead in zip((loads.force, *loads.charges), (allowed.force, *allowed.charges), strict=True):
            if name in values and np.any(values[name]):  # a charge of 0 is allowed in both kinds
                example = next(profile for profile, outline in PROFILES.items() if outline.contact == contact)
                raise FactorError(
                    f"{name}: the profile {profiles} has none; give {instead} [{FACTORS[instead].units}], or a profile "
                    f"such as {example}"
                )
    for name in OF_A_LINE if "line" not in contacts else ():
        if name in values:
            raise FactorError(f"{name}: the profile {profiles} has none; only contacts along a line have it")


def _check_elasticity(cases: FactorValues, body: str) -> None:
    """Require either the name of a base or punch, or both its modulus and Poisson's ratio."""
    modulus, poisson = f"{body}_modulus", f"{body}_poisson"
    for name in (modulus, poisson):
        cases.refuse(name, cases.has(name) & cases.has(body), f"beside a {body}; give either")
    for name, other in ((poisson, modulus), (modulus, poisson)):
        if np.any(cases.has(other) & ~cases.has(name)):
            raise _missing(name)


def _check_space(cases: FactorValues) -> None:
    """Refuse a cut, a direction of sliding or a height map outside space, and an insulating punch or flux in space."""
    mapped, values = cases.among("profile", "map"), cases.values
    if mapped.any() and HEIGHT_MAP not in values:
        raise FactorError(f"{HEIGHT_MAP}: missing; a file of heights or an array over x and y [m] (profile map)")
    for name in (name for name in (*OF_SPACE, HEIGHT_MAP) if name in values):
        if name == HEIGHT_MAP and not mapped.all():
            raise FactorError(f"{name}: only the profile map has one")
        if not cases.space.all():
            raise FactorError(
                f"{name}: only contacts in space have it: profile {', '.join(IN_SPACE)}, or {', '.join(ON_CUTS)} with "
                "a cut"
            )
    if cases.among("cut", *ANGLED_CUTS).any() and "cut_angle" not in values:
        raise _missing("cut_angle", ", as '36 deg'")
    if "cut_angle" in values and "cut" not in values:
        raise FactorError("cut: missing; must be rotated Y or tilt where there is a cut_angle")
    insulating, flux = cases.among("electric", "insulating"), cases.number("total_flux") != 0
    cases.refuse("electric", insulating & cases.space, "of a contact in space; must be conducting")
    cases.refuse("total_flux", flux & cases.space, "of a contact in space; must be 0")


def _check_films(cases: FactorValues) -> None:
    """Require a base of films, and refuse a film's factors of half-planes and a speed with layers or air."""
    layered_or_air = cases.kind_names != KINDS["line", False, False].name
    moves = cases.number("speed") != 0
    cases.refuse("speed", moves & layered_or_air, "m/s of what is no half-plane without air")
    if BODY in cases.values:
        _check_stacks(cases)
    film = cases.has("thickness")
    for name in OF_A_FILM[1:]:
        cases.refuse(name, cases.has(name) & ~film, "without a thickness; only a film has one")
    for value in cases.values["base"].flat if "base" in cases.values else ():
        if not (absent(value) or isinstance(value, str | Material)):
            raise FactorError(f"base: {shown(value)} is no material; must be {_BASE}")
    _check_elasticity(cases, "base")
    if np.any(film & ~cases.has("base") & ~cases.has("base_modulus")):
        raise FactorError(f"base: missing; must be {_BASE}")
    graded, exponent = cases.has("base_volume_fraction"), cases.has("grading_exponent")
    cases.refuse("base_volume_fraction", graded & cases.space, "grades a film below a contact in space")
    if "volume_fraction" not in cases.values:
        cases.refuse("base_volume_fraction", graded, "without a volume_fraction, which a graded film has on top")
    cases.refuse("grading_exponent", exponent & ~graded, "without a base_volume_fraction; only a graded film has one")


def _check_stacks(cases: FactorValues) -> None:
    """Refuse bodies that are not stacks, and factors of materials and layers beside stacks."""
    for value in cases.values[BODY].flat:
        if not isinstance(value, Stack):
            raise FactorError(f"{BODY}: {shown(value)} is no solver.Stack")
        if value.electroded:
            raise FactorError(f"{BODY}: {value.name}: electroded is said by the factor electrode: top")
    for name in ("material", "composite", "volume_fraction", "cut", "cut_angle", *OF_A_FILM):
        if name in cases.values:
            raise FactorError(f"{name}: beside a {BODY}; a stack has its own materials, thicknesses and interfaces")


def _check_gaps(cases: FactorValues) -> None:
    """Refuse permittivity and radius of a gap without air, and require the radius for cones and powers in air."""
    air, ended = cases.among("surroundings", AIR), cases.has("gap_radius")
    filled = cases.number("gap_permittivity") != FACTORS["gap_permittivity"].default
    for name, set_by_user in zip(OF_A_GAP, (filled, ended), strict=True):
        cases.refuse(name, set_by_user & ~air, f"without surroundings: {AIR}; only its gap has one")
    along_a_line = ~cases.among("profile", *POINTED)
    cases.refuse("gap_radius", ended & along_a_line, "beside a contact along a line; only a point's gap has one")
    if np.any(air & ~ended & cases.among("profile", "cone", "power")):
        raise _missing(
            "gap_radius",
            ": a cone or a power beside air says nowhere how wide the punch is, and the charge in its gap grows with "
            "that",
        )


def _check_electrodes(cases: FactorValues) -> None:
    """Refuse electrodes without a film, numbers that are not whole, and patches that touch."""
    names = [name for name in OF_AN_ELECTRODE if name in cases.values]
    for name in names:
        if (needed := _ELECTRODE_NEEDS.get(name)) and needed not in cases.values:
            raise _needed(name, needed)
    readable = [kind.name for kind in KINDS.values() if "collector" in kind.factors and not kind.air]
    for name in names:
        cases.refuse(name, cases.space, "of a contact in space; electrodes are read below lines and points")
        bare = ~cases.among(name, "none") & ~np.isin(cases.kind_names, readable)
        cases.refuse(name, bare, "without a film in insulated surroundings")
    if "collector" not in names:
        return
    number = cases.number("collector")
    cases.refuse("collector", number != np.floor(number), "is not a whole number >= 1 [1]")
    lines = np.isin(cases.kind_names, [kind.name for kind in KINDS.values() if kind.contact == "line"])
    cases.refuse("patch", cases.among("patch", "disc") & lines, "below a contact along a line; must be strip")
    touching = cases.number("patch_pitch") <= cases.number("patch_size")
    cases.refuse("patch_pitch", touching, "is not more than patch_size: a patch would touch its neighbour")


def _check_air(cases: FactorValues) -> None:
    """Refuse air beside line and point contacts whose punch has no gap that carries charge."""
    if not np.any(cases.among("surroundings", AIR) & ~cases.space):
        return
    for case in distinct_cases(cases.arrays)[1]:
        if case["surroundings"] == AIR and (why := airless(case)):
            raise FactorError(f"surroundings: 'air' is not allowed: {why}; must be insulated")


def _check_heat(cases: FactorValues) -> None:
    """Refuse heat without a film, or without its temperature and time."""
    names = [name for name in OF_HEAT if name in cases.values]
    if not names:
        return
    filmless = np.isin(cases.kind_names, [kind for kind in np.unique(cases.kind_names) if "film" not in kind])
    for name in names:
        cases.refuse(
            name, cases.space, "of a contact in space; heat is solved for contacts along a line and at a point"
        )
        cases.refuse(name, filmless, "without a film; heat needs its thickness")
        if np.any(np.isnan(cases.values[name])):
            raise FactorError(f"{name}: missing in a case; heat is asked of all cases or of none")
    if "touch_temperature" not in names:
        raise _needed(names[0], "touch_temperature")
    for name in names:
        if (needed := _HEAT_NEEDS.get(name, name)) not in names:
            raise _needed(name, needed)
