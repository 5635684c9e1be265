"""``meecontact material``: the list of the library, and one material in full."""

import argparse
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from approximation.arrays import Array
from solver import Material, MaterialError, find, limiting_speed, materials
from solver.described import Described
from solver.halfplane.surface import HalfPlane
from solver.material import datasheet
from solver.material.constants import TRIGONAL, UNITS
from solver.material.cuts import rotation
from solver.material.datasheet import strain_charge, stress_matrices
from solver.material.evidence import Sourced
from solver.material.punches import punches
from solver.names import COMPOSITES, FACTORS, LIMITS, THERMAL
from solver.units import VACUUM_PERMITTIVITY
from workflow.cli.words import printable
from workflow.language.numbers import shown
from workflow.study.reading import InputError, read_material

_WIDE, _DIGITS = 100, 6  # columns of what is printed, and digits of a constant
#: Usual names of equal units of permeabilities and of magnetoelectric constants.
_KNOWN_AS = {"N s2 C-2": "H m-1", "N s V-1 C-1": "s m-1"}
#: Units of the slopes of (u_y, phi, psi) by (sigma_yy, D_y, B_y).
_COMPLIANCE = (("Pa-1", "V m N-1", "A m N-1"), ("V m N-1", "V m C-1", "A m C-1"), ("A m N-1", "A m C-1", "A2 N-1"))


def show(options: argparse.Namespace) -> None:
    """Print the list of all materials, or all that is known of one material or punch."""
    name = options.material
    if name is None:
        print(listed())
        return
    punch = _of_punch(name) if name in punches() and not Path(name).exists() else []
    material = [] if punch and name not in materials() else [_of_material(name, Path(name))]
    print(printable("\n".join([*material, *punch])))


def listed() -> str:
    """Return a line for each library material: name, a mark where its constants are in doubt, coupling, source."""
    known = materials()
    width = max(map(len, known))
    lines = [
        _filled(
            f"{name:{width}s} {'*' if material.note or material.alternatives else ' '} {_coupling(material):24s}",
            material.source,
        )
        for name, material in known.items()
    ]
    lines.append(
        _filled("*", "repaired, doubtful or disputed: meecontact material NAME says what, with constants and roots")
    )
    mixed = ", ".join(f"{name} ({fraction})" for name, fraction in COMPOSITES.items())
    lines.append(_filled("composites, and the factor each takes:", mixed))
    lines.append(_filled("punches, also as meecontact material NAME:", ", ".join(punches())))
    lines.append("own materials: meecontact material FILE.yaml")
    return "\n".join(lines)


def _filled(head: str, text: str) -> str:
    """Return a text behind its head, in lines of `_WIDE` that begin at one column."""
    return textwrap.fill(
        text, _WIDE, initial_indent=f"{head} ", subsequent_indent=" " * (len(head) + 1), break_on_hyphens=False
    )


def _coupling(material: Material) -> str:
    electric, magnetic = (
        any(np.any(getattr(material, f"{letter}{axes}")) for axes in ("31", "33", "15")) for letter in "ef"
    )
    electric = electric or bool(np.any(material.e11))
    if electric and magnetic:
        return "magneto-electro-elastic"
    return "piezoelectric" if electric else "piezomagnetic" if magnetic else "elastic"


def _of_punch(name: str) -> list[str]:
    punch = punches()[name]
    stiffness = f"modulus {shown(punch.modulus, 'Pa', _DIGITS)}, Poisson's ratio {punch.poisson:g}"
    return [
        _filled(f"{name} as a punch:", punch.source),
        f"  {stiffness}, density {punch.density:g} kg/m3, {'conducts' if punch.conducts else 'does not conduct'}",
        *_sourced("for heat", punch.thermal, THERMAL),
    ]


def _sourced(heading: str, values: Mapping[str, Sourced], described: Mapping[str, Described]) -> list[str]:
    """Return lines with values and their sources below a heading; none without values."""
    return [heading] * bool(values) + [
        _filled(f"  {name:16s}  {shown(known.value, described[name].units, _DIGITS):11s}", known.source)
        for name, known in values.items()
    ]


def _of_material(name: str, path: Path) -> str:
    if name in COMPOSITES and not path.exists():
        raise InputError(
            f"material: {name!r} is a composition, not one material: a case says composite={name} and "
            f"{COMPOSITES[name]}, {FACTORS[COMPOSITES[name]].allowed}"
        )
    material = read_material(path)[1] if path.suffix in (".yaml", ".yml") or path.exists() else find(name)
    if not material.axial:
        return _described(material, None)
    with np.errstate(all="ignore"):  # what is not finite is named below
        half = HalfPlane(material)
        if not (np.isfinite(half.compliance).all() and np.isfinite(half.friction_coupling).all()):
            raise MaterialError(f"{material.name}: constants beyond what double precision can solve")
        return _described(material, half)


def _described(material: Material, half: HalfPlane | None) -> str:
    """Return the text of a material; without `half` that of a crystal for contacts in space."""
    texts = (("source:", material.source), ("note:", material.note))
    lines = [f"{_in_line(material.name)}: admissible"]
    lines += [_filled(label, text) for label, text in texts if text]
    lines += ["a conductor: one potential inside, its permittivity has no part"] if material.conductor else []
    vacuum = [name for name in ("eps11", "eps33") if getattr(material, name) == VACUUM_PERMITTIVITY]
    if vacuum and _coupling(material) not in ("elastic", "piezomagnetic"):
        lines.append(f"note: {' and '.join(vacuum)} of vacuum, as of a file that has no {' and no '.join(vacuum)}")
    lines.append("constants")
    lines += [_constant(material, name) for name in UNITS if not np.isnan(getattr(material, name))]
    lines += [_constant(material, name) for name in TRIGONAL if getattr(material, name)]
    for variant, other in zip(material.variants(), material.alternatives, strict=True):
        values = ", ".join(f"{name} = {shown(value, _units(name), _DIGITS)}" for name, value in other.constants.items())
        lines.append(_filled(f"{_in_line(variant.name)}:", f"{values}: {other.source}"))
    lines += _strain_form(material)
    lines += _sourced("limits", material.limits, LIMITS)
    lines += _sourced("for heat", material.thermal, THERMAL)
    if half is None:
        lines.append(f"surface x, y, normal in the crystal's axes ({material.cut or 'Z'})")
        return "\n".join(
            [*lines, *("  " + "".join(f"{axis:+.6f}  " for axis in row).rstrip() for row in rotation(material.cut))]
        )
    lines.append("Stroh roots")
    lines += [f"  {p.real:+.6f} {p.imag:+.6f}i" for p in half.roots]
    if not np.isnan(material.rho):
        speed = shown(float(limiting_speed(material)), "m s-1", _DIGITS)
        lines.append(f"limiting speed of a conducting punch: {speed}")
    lines.append("compliance N: slopes of (u_y, phi, psi) by (sigma_yy, D_y, B_y)")
    lines += [_row(*row) for row in zip(half.compliance, _COMPLIANCE, strict=True)]
    lines.append("friction coupling k of (u_y, phi, psi)")
    lines.append(_row(half.friction_coupling, [units[0] for units in _COMPLIANCE]))
    return "\n".join(lines)


def _row(values: Array, units: Sequence[str]) -> str:
    """Return a row of numbers with their units, in columns."""
    cells = [shown(float(value), unit, _DIGITS) if value else "0" for value, unit in zip(values, units, strict=True)]
    return "  " + "".join(f"{cell:24s}" for cell in cells).rstrip()


def _constant(material: Material, name: str) -> str:
    """Return a line with a constant, its unit and its range over other sources."""
    units = _units(name)
    line = f"  {name:6s} {shown(float(getattr(material, name)), units, _DIGITS)}"
    if name not in material.spread:
        return line
    low, high = (shown(end, units, _DIGITS) for end in material.spread[name])
    return f"{line:31s} {low} to {high} by source"


def _strain_form(material: Material) -> list[str]:
    """Return lines with compliance, charge constants, free permittivity and coupling factors, as on data sheets."""
    values = {name: float(getattr(material, name)) for name in UNITS}
    if (
        np.isnan(values["c12"])
        or material.conductor
        or not material.axial
        or not (values["e33"] or values["e31"] or values["e15"])
    ):
        return []
    c, e, eps = stress_matrices(values)
    form = strain_charge(c, e, eps)
    units = {**datasheet.UNITS, "kt": "1"}
    lines = [
        f"  {name:8s} {f'{value * 1e12:.4g}e-12 m²/N' if name[0] == 's' else shown(value, units[name], 4)}"
        for name, value in form.items()
    ]
    return ["strain-charge form, as data sheets print it", *lines]


def _units(name: str) -> str:
    """Return the unit of a constant as data sheets write it."""
    units = (UNITS | TRIGONAL)[name]
    return _KNOWN_AS.get(units, units)


def _in_line(text: str) -> str:
    return " ".join(text.split())
