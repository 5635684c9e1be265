"""The circular punch in 50 digits (mpmath), by other methods than the closed form wherever there is one.

Only the tractions follow the theory (section 3, ``verification.oracles.contact``). Material constants come from angular
integrals, punch response and fields outside the contact from double-exponential quadrature of the tractions, peak and
edge values from a search and from limits, tangents from differences.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mpmath import inverse, matrix, mp, mpf, nan, pi, sqrt

from verification.oracles.contact import Contact, Sliding
from verification.oracles.half_plane import WORK_DIGITS, half_plane

_STEP = mpf("1e-25")  # of central differences: truncation and cancellation both leave about 50 digits
_EDGE = mpf("1e-95")  # distance from an edge, over the contact width, at which limits are read

FIELDS = (
    "contact_pressure",
    "shear_traction",
    "electric_displacement_y",
    "magnetic_induction_y",
    "stress_xx",
    "electric_displacement_x",
    "magnetic_induction_x",
)


@dataclass(frozen=True)
class Solution:
    """Quantities and surface fields of a case, named as in ``solver.names``."""

    # All but the three peaks over the interior; NaN where the potential of a field that the punch does not conduct
    # is needed.
    quantities: dict[str, mpf]
    fields: dict[str, list[mpf]]  # ``FIELDS``, one value per position


def solve(
    material: Mapping[str, float],
    *,
    radius: float,
    load: float,
    friction: float = 0.0,
    charge: float = 0.0,
    magnetic_charge: float = 0.0,
    datum: float = 1.0,
    electric: str = "conducting",
    magnetic: str = "conducting",
    speed: float = 0.0,
    positions: Sequence[float] = (),
) -> Solution:
    """One case of the circular punch; factors and outputs as in ``solver.names``, SI units."""
    conducted = tuple(i for i, kind in ((1, electric), (2, magnetic)) if kind == "conducting")
    if any(q and i not in conducted for i, q in ((1, charge), (2, magnetic_charge))):
        raise ValueError("an insulating punch carries no charge")
    with mp.workdps(WORK_DIGITS):
        sliding = Sliding(half_plane(material, speed), mpf(friction), mpf(radius), conducted)
        state = Contact(sliding, mpf(load), mpf(charge), mpf(magnetic_charge))
        quantities = _geometry(state) | _edges(state) | _response(state, mpf(datum))
        rows = [_surface(state, mpf(X)) for X in positions]
        return Solution(quantities, {name: [row[i] for row in rows] for i, name in enumerate(FIELDS)})


def _geometry(state: Contact) -> dict[str, mpf]:
    alpha, width = state.sliding.alpha, state.width
    return {
        "contact_trailing": (1 - alpha) * width,
        "contact_leading": alpha * width,
        "pressure_exponent": alpha,
        "peak_pressure": _maximum(state),
    }


def _maximum(state: Contact) -> mpf:
    """Largest pressure, by ternary search (half the working digits in its place, all of them in its value)."""

    def pressure(u: mpf) -> mpf:
        return -state.tractions(u, 1 - u)[1]

    low, high = mpf(0), mpf(1)
    while (third := (high - low) / 3) > mpf(10) ** (-WORK_DIGITS // 2):
        if pressure(low + third) > pressure(high - third):
            high -= third
        else:
            low += third
    return pressure(low)


def _edges(state: Contact) -> dict[str, mpf]:
    """Limits at the two edges: intensities from within, sigma_xx from outside."""
    distance = sqrt(2 * pi * state.width * _EDGE)
    trailing, leading = state.tractions(_EDGE, 1 - _EDGE), state.tractions(1 - _EDGE, _EDGE)
    return {
        "electric_edge_intensity_trailing": distance * trailing[2],
        "electric_edge_intensity_leading": distance * leading[2],
        "magnetic_edge_intensity_trailing": distance * trailing[3],
        "magnetic_edge_intensity_leading": distance * leading[3],
        "trailing_tension": _stress_at_edge(state, mpf(1)),
        "leading_compression": _stress_at_edge(state, mpf(-1)),
    }


def _stress_at_edge(state: Contact, X: mpf) -> mpf:
    """sigma_xx just outside: no traction there, and u_x,x comes from the shear traction alone."""
    stretch = matrix([state.sliding.half.compliance[0, 0] * state.shear_transform_at_edge(X), 0, 0, 0])
    return _along_surface(state, stretch, matrix(4, 1))[0]


def _along_surface(state: Contact, u_x: matrix, traction: matrix) -> matrix:
    """t_1 = (sigma_xx, sigma_xy, D_x, B_x) from u,x and t_2, by the constitutive law alone."""
    half = state.sliding.half
    u_y = inverse(half.T) * (traction - half.R.T * u_x)
    return half.Q * u_x + half.R * u_y


def _surface(state: Contact, X: mpf) -> list[mpf]:
    """The fields ``FIELDS`` at one position, from theory (2.1) and the constitutive law."""
    half, inside = state.sliding.half, abs(X) < 1
    if abs(X) == 1:
        raise ValueError("the fields have no value on an edge, X = +-1")
    u, v = (1 - X) / 2, (1 + X) / 2
    traction = matrix(state.tractions(u, v)) if inside else matrix(4, 1)
    transform = matrix(state.transforms_inside(u, v) if inside else state.transforms_outside(X))
    stress_xx, _, d_x, b_x = _along_surface(state, half.local * traction + half.compliance * transform, traction)
    return [-traction[1], traction[0], traction[2], traction[3], stress_xx, d_x, b_x]


def _response(state: Contact, datum: mpf) -> dict[str, mpf]:
    """Punch response (theory section 6, by quadrature) and its tangents (by differences)."""
    depth, voltage, magnetic_potential = state.punch_response(datum)
    slope = {name: _tangent(state, datum, name) for name in ("load", "charge", "magnetic_charge")}
    bare = replace(state, charge=mpf(0), magnetic_charge=mpf(0))
    at_bare, bare_slope = bare.punch_response(datum), _tangent(bare, datum, "load")
    known = {i: mpf(1) if i in state.sliding.conducted else nan for i in (1, 2)}
    out = {
        "depth": depth,
        "voltage": voltage * known[1],
        "magnetic_potential": magnetic_potential * known[2],
        "voltage_per_load": bare_slope[1] * known[1],
        "magnetic_potential_per_load": bare_slope[2] * known[2],
    }
    names = ("charge_per_force", "stroke_per_volt", "blocked_load_per_volt")
    names_magnetic = ("flux_per_force", "stroke_per_ampere", "blocked_load_per_ampere")
    for i, source, (sensitivity, stroke, blocked) in ((1, "charge", names), (2, "magnetic_charge", names_magnetic)):
        if i not in state.sliding.conducted:
            out |= dict.fromkeys((sensitivity, stroke, blocked), nan)
            continue
        by_load, by_source = slope["load"], slope[source]
        out[sensitivity] = -at_bare[i] / by_source[i] / state.load
        out[stroke] = by_source[0] / by_source[i]
        # At fixed depth a load dP goes with a charge -dP depth_P/depth_T.
        out[blocked] = by_source[0] / (by_load[i] * by_source[0] - by_source[i] * by_load[0])
    return out


def _tangent(state: Contact, datum: mpf, name: str) -> list[mpf]:
    """Derivatives of (depth, voltage, magnetic_potential) in the load or a charge, by central differences."""
    value = getattr(state, name)
    step = value * _STEP if name == "load" else mpf(1)  # affine in the charges: any step is exact
    ahead = replace(state, **{name: value + step}).punch_response(datum)
    behind = replace(state, **{name: value - step}).punch_response(datum)
    return [(p - m) / (2 * step) for p, m in zip(ahead, behind, strict=True)]
