"""Exact similarity of contacts: powers by which factors and quantities scale with size and strength.

*Size* l: radius, load, charges, thickness, width and datum times l give the same stresses on l times the lengths.
*Strength* s: load, charges and slope times s, the radius over s, give s times the stresses and potentials on the same
lengths, unless air is beside the contact: its gap is s times as wide, so that its permittivity and permeability would
have to be s times as large. Factors and quantities that are not named here stay (theory, section 8).
"""

from dataclasses import dataclass

from solver.fields import EVERY_FIELD, EVERY_INTERIOR
from solver.names import ALL_QUANTITIES


@dataclass(frozen=True)
class Weight:
    """Powers of size and strength that multiply a factor or a quantity under similarity."""

    size: float = 0.0
    strength: float = 0.0


_FORCE, _LENGTH, _STRESS, _INTENSITY = Weight(1.0, 1.0), Weight(1.0), Weight(0.0, 1.0), Weight(0.5, 1.0)

#: Factors that change under similarity.
FACTOR_WEIGHTS: dict[str, Weight] = {
    **dict.fromkeys(("radius", "radius_x", "radius_y", "crown_radius"), Weight(1.0, -1.0)),
    **dict.fromkeys(("length", "width", "datum", "thickness", "gap_radius", "map_spacing"), _LENGTH),
    **dict.fromkeys(("longest_wavelength", "shortest_wavelength"), _LENGTH),
    **dict.fromkeys(("patch_size", "patch_position", "patch_pitch"), _LENGTH),
    **dict.fromkeys(("slope", "tilt"), _STRESS),
    **dict.fromkeys(("load", "charge", "magnetic_charge", "roughness"), _FORCE),
    **dict.fromkeys(("moment", "force", "total_charge", "total_flux"), Weight(2.0, 1.0)),
}

_CHANGING: dict[Weight, tuple[str, ...]] = {
    _LENGTH: ("contact_trailing", "contact_leading", "contact_offset", "peak_von_mises_depth",
        "contact_radius", "blocked_force_per_volt", "blocked_force_per_ampere", "capacitance",
        "capacitance_at_force", "permeance",
         "contact_stiffness", "contact_stiffness_open", "contact_length_x", "contact_length_y",
    ),
    Weight(2.0): ("contact_area",),
    Weight(2.0, 1.0): ("friction_force_x", "friction_force_y"),
    Weight(3.0, 1.0): ("moment_x", "moment_y", "moment_z"),
    _FORCE: ("depth", "voltage", "magnetic_potential"),
    _INTENSITY: tuple(name for name in ALL_QUANTITIES if "_edge_intensity" in name),
    Weight(-1.0): ("voltage_per_force", "magnetic_potential_per_force",
        "patch_charge_gradient"),
    _STRESS: (
        "peak_pressure", "trailing_tension", "leading_compression", "nominal_field", "peak_von_mises",
        "peak_principal_tension", "interface_shear", "interface_tension", "film_peak_von_mises", "peak_displacement",
        "electrode_pressure",
        "film_peak_principal_tension", "base_peak_von_mises", "base_peak_principal_tension",
    ),
}  # fmt: skip

#: Quantities, fields (at the same position relative to the contact) and sizes of curves by name; exponents,
#: sensitivities, strokes, blocked loads, capacitances and dimensionless positions do not change.
QUANTITY_WEIGHTS: dict[str, Weight] = {
    **dict.fromkeys(ALL_QUANTITIES, Weight()),
    **{name: weight for weight, names in _CHANGING.items() for name in names},
    **dict.fromkeys((*EVERY_FIELD, *EVERY_INTERIOR), _STRESS),
    "electric_potential": _FORCE,
    "magnetic_potential": _FORCE,
    "half_length": _LENGTH,
    "mean_pressure": _STRESS,
    "load_over_thickness": _STRESS,
}


def weight_of(factor: str) -> Weight:
    """Return the powers of a factor, or of a study's thickness of a layer, such as ``copper_thickness``."""
    return FACTOR_WEIGHTS.get("thickness" if factor.endswith("_thickness") else factor, Weight())


def scale_powers(quantity: str, load: str, length: str) -> dict[str, float]:
    """Return powers of a load-like and a length-like factor whose product scales like a quantity."""
    if quantity not in QUANTITY_WEIGHTS:
        raise ValueError(f"{quantity!r} has no known powers of size and strength")
    a, b, target = weight_of(load), weight_of(length), QUANTITY_WEIGHTS[quantity]
    determinant = a.size * b.strength - a.strength * b.size
    if determinant == 0:
        raise ValueError(f"{load!r} and {length!r} scale alike")
    return {
        load: (target.size * b.strength - target.strength * b.size) / determinant,
        length: (a.size * target.strength - a.strength * target.size) / determinant,
    }
