"""``meecontact material``: the list of what is built in, and one material in full."""

from pathlib import Path

import numpy as np

from solver import Material, MaterialError, find, limiting_speed, materials
from solver.halfplane.surface import HalfPlane
from solver.material.constants import UNITS
from solver.names import COMPOSITES, FACTORS, LIMITS
from workflow.study.reading import InputError, read_material


def listed() -> str:
    """A line for every built-in material: name, a mark where its constants are in doubt, coupling, source."""
    known = materials()
    width = max(map(len, known))
    lines = [
        f"{name:{width}s} {'*' if own.note or own.alternatives else ' '} {_coupling(own):23s}  {own.source}"
        for name, own in known.items()
    ]
    lines.append("* repaired, doubtful or disputed: meecontact material NAME says what, with the constants and roots")
    mixed = ", ".join(f"{name} ({fraction})" for name, fraction in COMPOSITES.items())
    lines.append(f"composites, and the factor each takes: {mixed}")
    lines.append("own materials: meecontact material FILE.yaml")
    return "\n".join(lines)


def _coupling(material: Material) -> str:
    electric, magnetic = (
        any(np.any(getattr(material, f"{letter}{axes}")) for axes in ("31", "33", "15")) for letter in "ef"
    )
    if electric and magnetic:
        return "magneto-electro-elastic"
    return "piezoelectric" if electric else "piezomagnetic" if magnetic else "elastic"


def described(name: str) -> str:
    """Constants, alternatives, limits, Stroh roots and compliance of a built-in material, or of a material's file.

    Raises
    ------
    InputError, MaterialError
        A material that is unknown, inadmissible, or beyond what double precision can solve.
    """
    path = Path(name)
    if name in COMPOSITES and not path.exists():
        raise InputError(
            f"material: {name!r} is a composition, not one material: a case says composite={name} and "
            f"{COMPOSITES[name]}, {FACTORS[COMPOSITES[name]].allowed}"
        )
    material = read_material(path)[1] if path.suffix in (".yaml", ".yml") or path.exists() else find(name)
    with np.errstate(all="ignore"):  # what is not finite is named below
        half = HalfPlane(material)
        if not (np.isfinite(half.compliance).all() and np.isfinite(half.friction_coupling).all()):
            raise MaterialError(f"{material.name}: constants beyond what double precision can solve")
        return _described(material, half)


def _described(material: Material, half: HalfPlane) -> str:
    texts = (("source", material.source), ("note", material.note))
    lines = [f"{_in_line(material.name)}: admissible"]
    lines += [f"{label}: {_in_line(text)}" for label, text in texts if text]
    lines += ["a conductor: one potential inside, its permittivity has no part"] if material.conductor else []
    lines.append("constants")
    lines += [_constant(material, name) for name in UNITS if not np.isnan(getattr(material, name))]
    for variant, other in zip(material.variants(), material.alternatives, strict=True):
        values = ", ".join(f"{name} = {value:.6g} {UNITS[name]}" for name, value in other.constants.items())
        lines.append(f"{_in_line(variant.name)}: {values}: {_in_line(other.source)}")
    lines += ["limits"] if material.limits else []
    for name, limit in material.limits.items():
        lines.append(f"  {name:16s} {limit.value:< 14.6g} {LIMITS[name].units:6s} {_in_line(limit.source)}")
    lines.append("Stroh roots")
    lines += [f"  {p.real:+.6f} {p.imag:+.6f}i" for p in half.roots]
    if not np.isnan(material.rho):
        speed = float(limiting_speed(material))
        lines.append(f"limiting speed of a conducting punch: {speed:.6g} m/s")
    lines.append("compliance N of (u_y, phi, psi) to (sigma_yy, D_y, B_y), SI")
    lines += ["  " + "  ".join(f"{value: .6e}" for value in row) for row in half.compliance]
    lines.append("friction coupling k of (u_y, phi, psi), SI")
    lines.append("  " + "  ".join(f"{value: .6e}" for value in half.friction_coupling))
    return "\n".join(lines)


def _constant(material: Material, name: str) -> str:
    """A constant with its unit, and where other sources have it."""
    line = f"  {name:6s} {float(getattr(material, name)):< 14.6g} {UNITS[name]}"
    if name not in material.spread:
        return line
    low, high = material.spread[name]
    return f"{line:38s} {low:.6g} to {high:.6g} by source"


def _in_line(text: str) -> str:
    return " ".join(text.split())
