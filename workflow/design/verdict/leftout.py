"""The error budget of a case: effects that the model leaves out, by plain formulas of the solved case, largest first.

Each formula has its source in its docstring; docs/design.md lists them with default sizes.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, Any

import numpy as np
import scipy  # scipy.optimize, slow to import, and few designs need it
import xarray as xr

from approximation.arrays import Array
from solver import FactorError, Material, MaterialError, Stack, solve
from solver.body import Kind
from solver.face.factorvalues import absent
from solver.face.filmbodies import stack_of
from solver.face.heat import charged_area, responses
from solver.face.strain import DEEP, WIDE
from solver.heat.charge import film_gap
from solver.heat.touch import Spot
from solver.material.punches import RIGID_PUNCH, punches
from solver.names import BODY, CHOICES, FACTORS, NEVER_TEMPERATURE
from workflow.language import titles
from workflow.language.constants import DEVICE
from workflow.language.numbers import number, shown
from workflow.language.titles import capital
from workflow.study import layered
from workflow.study.allowable import Allowable
from workflow.study.model import Study
from workflow.study.uncertainty import USUAL

#: Ratio to the printed band up to which an effect does not change a recommendation.
MOST = 3.0
#: Default sizes where the case names none.
ROUGHNESS = 10e-9  # m rms: a lapped ball or a polished film
TILT = 1e-4  # rad: 0.1 mm per metre, a good fixture
LENGTH = 10e-3  # m of a line
ADHESION = 0.05  # J/m2: clean metal or polymer in air, as in docs/limits.md
BIAS = 1e-12  # A: of a usual FET input
PAD = 1e-3  # m: diameter or width of a pad that is read
SUPPORT = 10e-3  # m from the force to the supports of a base
WARMER, HOLD = 1.0, 1.0  # K and s: temperature difference of a touch, and its duration
_SOFT = 1e9  # Pa, Young's modulus of a punch below which its own depth is no small part
DENSITY = 7800.0  # kg/m3 of steel: of a rigid punch, and of one without a name
GRAVITY = 9.81  # m/s2
ATOMS = 0.3e-9  # m: distance over which surfaces attract each other
SPARK = 65e6  # V/m: from which gaps of air up to 4 um spark

# most change of a film's charge per force over 2 R rms/a^2: 65 rough balls in space on PZT-4 and PVDF, a/h 0.2 to 10
_CHARGE_MOVES = 0.22
# most length by which both ends of a line add to a film's charge, over a + h and in air over (2 R film_gap)^1/2: 53
# rollers in space on PZT-4, BaTiO3, PVDF and AlN, a/h 0.1 to 4, R/h 25 to 2500
_ENDS, _ENDS_IN_AIR = 0.6, 0.4
_STEEP = 0.01  # rms over the contact's radius: waves that long and higher have slopes that no polish leaves
_FEW = 0.1  # share of the charge from which bending and the end of a pad matter, and of the force a weight
_STEP = 1.1  # factor of the load for the powers by which depth and pressure grow
_APART = 3.8  # p*/p0 at which both laws of roughness meet
_ROUND = ("sphere", "rough_sphere", "cylinder", "roller")
_READ = ("patch_charge_per_force", "electrode_charge_per_force", "charge_per_force")
_CAPACITANCE = ("capacitance_at_force", "capacitance_at_load", "capacitance", "capacitance_per_length")


@dataclass(frozen=True)
class LeftOut:
    """One effect that the model leaves out, at one case."""

    left_out: Annotated[str, "effect that the model leaves out"]
    left_out_moves: Annotated[
        str, "what the effect moves: the signal, the stress, or both; empty for what only informs"
    ]
    left_out_size: Annotated[float, "size of the effect at this design, over its unit in left_out_units"]
    left_out_matters: Annotated[float, "size at which the effect matters, over its unit in left_out_units"]
    left_out_units: Annotated[str, "unit of the effect's size"]
    left_out_share: Annotated[float, "relative change by the effect of what it moves"]
    left_out_ratio: Annotated[float, "that change over the printed band"]
    left_out_brief: Annotated[str, "the effect in few words"]
    left_out_words: Annotated[str, "the effect in one sentence"]


@dataclass(frozen=True, eq=False)
class SolvedCase:
    """A case with its solver, materials and device."""

    kind: Kind
    factors: Mapping[str, Any]
    solve: Callable[[Mapping[str, Any]], xr.Dataset]
    allowable: Callable[[str], Allowable]  # ValueError where a limit is not known
    device: Mapping[str, float]  # numbers of a study's section ``device``; empty without one
    smallest_force: float = np.nan  # [N]
    materials: Mapping[str, Material] = field(default_factory=dict)  # beside the library's
    phases: Sequence[str] = ("BaTiO3", "CoFe2O4")
    body: Stack | None = None  # of a study's body
    band: float = np.nan  # the printed relative band; NaN: the least spread of published constants
    hold: float = HOLD  # [s] from the touch to the reading, where the factors name none

    @cached_property
    def solved(self) -> Mapping[str, float]:
        """Quantities of the case."""
        return self.quantities({})

    def quantities(self, others: Mapping[str, float | str]) -> Mapping[str, float]:
        """Return quantities of the case with some other factors."""
        out = self.solve({**self.factors, **others})
        return {str(name): float(out[name].squeeze()) for name in out.data_vars if out[name].size == 1}

    @cached_property
    def read_out(self) -> tuple[Mapping[str, float], str]:
        """Quantities at the voltage that the amplifier leaves, and the circuit in words."""
        charge, force = self.kind.loads.charges[0], self.kind.loads.force
        known = {"voltage", "charge_per_force"} <= self.solved.keys() and self.solved["voltage"]
        charge_is_fixed = self.factors.get(charge) or not {"electrode", "collector"}.isdisjoint(self.factors)
        if charge_is_fixed or not known or "input_capacitance" not in self.device:
            return self.solved, "at the punch's charge" if self.factors.get(charge) else "at open circuit"
        charge_at_zero_volts = self.solved["charge_per_force"] * float(self.factors[force])
        if "feedback_capacitance" in self.device:
            at_zero = self.quantities({charge: charge_at_zero_volts})
            return {name: at_zero[name] for name in at_zero if name != "nominal_field"}, "at zero volts"
        # input and cable share the charge with the contact's capacitance
        circuit = self.device["input_capacitance"] + self.device.get("cable_capacitance", 0.0)
        share = circuit / (circuit + abs(charge_at_zero_volts / self.solved["voltage"]) * self.length)
        return self.quantities({charge: share * charge_at_zero_volts}), "with the amplifier's input"

    @property
    def reading_time(self) -> float:
        """Time from the touch to the reading [s]."""
        return float(self.factors.get("hold", self.hold))

    @property
    def profile(self) -> str:
        """Name of the punch's profile."""
        return str(self.factors.get("profile", CHOICES["profile"][0]))

    @property
    def point(self) -> bool:
        """Return whether the contact is at a point."""
        return self.kind.contact == "point"

    @property
    def length(self) -> float:
        """Length of a line [m]; 1 of a point, whose forces are whole."""
        return 1.0 if self.point else self.device.get("electrode_length", LENGTH)

    @property
    def force(self) -> float:
        """Normal force on the whole punch [N]."""
        return float(self.factors["force"]) if self.point else float(self.factors["load"]) * self.length

    @property
    def half(self) -> float:
        """Radius of the contact, or half of its width [m]."""
        if self.point:
            space = "contact_length_x" in self.solved
            return self.solved["contact_length_x"] / 2 if space else self.solved["contact_radius"]
        return (self.solved["contact_trailing"] + self.solved["contact_leading"]) / 2

    @property
    def radius(self) -> float | None:
        """Radius of a ball, cylinder or roller [m]; None of other punches."""
        return float(self.factors["radius"]) if self.profile in _ROUND else None

    @property
    def read(self) -> str | None:
        """Name of the charge per force that is read; None where none is."""
        return next((name for name in _READ if name in self.solved), None)

    @property
    def charge(self) -> float:
        """Size of the charge that is read [C]; NaN where none is."""
        return (abs(self.solved[self.read]) * self.force or np.nan) if self.read else np.nan

    @property
    def stack(self) -> Stack | None:
        """Layers of a film; None of a half-space, of a graded film and of a base by its modulus."""
        unknown = (self.factors.get(name) for name in ("base_volume_fraction", "base_modulus"))
        if self.body or not self.kind.layered or not all(map(absent, unknown)):
            return self.body
        try:
            return stack_of(self.factors, self.materials, self.phases)
        except (FactorError, MaterialError):
            return None

    @property
    def shown_band(self) -> float:
        """Printed band, or the least difference of published constants."""
        return self.band if self.band > 0 else USUAL


def of_study(study: Study, factors: Mapping[str, Any], smallest_force: float, band: float) -> SolvedCase:
    """Return a case of a study, with its device, for the budget."""
    device = dict(study.device.constants) if study.device else {}
    device |= {name: float(factors[name]) for name in DEVICE if study.device and name in factors}
    return SolvedCase(
        kind=study.kind,
        factors=factors,
        solve=lambda case: study.solved(solve, case),
        allowable=study.allowable,
        device=device,
        smallest_force=smallest_force,
        materials=study.own_materials,
        phases=study.phases,
        body=layered.stack(study.body, dict(factors), study.own_materials, study.phases) if study.body else None,
        band=band,
        hold=study.signal.hold if study.signal else HOLD,
    )


def budget(case: SolvedCase, pressed: SolvedCase | None = None) -> tuple[LeftOut, ...]:
    """Return effects that the model leaves out, the largest against the printed band first; stresses in `pressed`."""
    effects = [effect for part in _BY_SIGNAL for effect in part(case)]
    effects += [effect for part in _BY_STRESS for effect in part(pressed or case)]
    return tuple(sorted(effects, key=_rank))


def _rank(effect: LeftOut) -> float:
    """Sort by the ratio to the band; exceeded limits follow effects above `MOST`, effects without a ratio are last."""
    if np.isfinite(effect.left_out_ratio):
        return -effect.left_out_ratio
    return -MOST if effect.left_out_size > effect.left_out_matters else 1.0


def largest(effects: Sequence[LeftOut], moved: Set[str]) -> LeftOut | None:
    """Return the largest effect above `MOST` times the printed band on what matters to a question; None without one."""
    beyond = (effect for effect in effects if effect.left_out_ratio > MOST)
    return next((effect for effect in beyond if not moved.isdisjoint(effect.left_out_moves.split(", "))), None)


def _effect(
    case: SolvedCase,
    name: str,
    moves: str,
    size: float,
    matters: float,
    units: str,
    share: float,
    brief: str,
    detail: str,
) -> LeftOut:
    words = f"{capital(brief)}{detail}."
    return LeftOut(name, moves, size, matters, units, share, share / case.shown_band, brief, words)


def _unknown(case: SolvedCase, name: str, moves: str, units: str, brief: str = "") -> LeftOut:
    """Return an effect without a figure; by default one without a formula for the profile of the punch."""
    brief = brief or f"{name} is not figured for the profile {case.profile}"
    return _effect(case, name, moves, np.nan, np.nan, units, np.nan, brief, "")


def _times(share: float) -> str:
    return f"{number(share, 2)} times" if share >= 1 else f"{number(100 * share, 2)} % of"


def _raised(most: str, factor: float) -> str:
    return f"{most}{number(factor, 2)} times" if factor > 1.1 else f"by {most}{number(100 * (factor - 1), 2)} %"


def _constants(case: SolvedCase) -> Iterator[LeftOut]:
    band, source = case.shown_band, ", one standard deviation of published values"
    if not case.band > 0:
        source = ", the least that published values differ by"
    brief = f"constants spread by ± {number(100 * band, 2)} %"
    yield _effect(case, "constants", "signal, stress", band, band, "1", band, brief, source)


def _strain(case: SolvedCase) -> Iterator[LeftOut]:
    """Yield small strain: the parabola is off by (a/R)^2 of the circle; a film is strained by depth/thickness."""
    if case.radius:
        ratio = case.half / case.radius
        brief = f"the contact is {number(ratio, 2)} of the punch's radius"
        detail = f"; strains are small up to {WIDE:g} of it"
        yield _effect(case, "small strain", "signal, stress", ratio, WIDE, "1", ratio**2, brief, detail)
    if "thickness" in case.factors and "depth" in case.solved and case.kind.datum == "absolute":
        ratio = abs(case.solved["depth"]) / float(case.factors["thickness"])
        punch = punches().get(str(case.factors.get("punch") or RIGID_PUNCH))
        included = ", that of the punch included," if punch and punch.modulus < _SOFT else ""
        brief = f"the depth{included} is {number(ratio, 2)} of the film's thickness"
        detail = f"; strains are small up to {DEEP:g} of it"
        yield _effect(case, "strain of the film", "signal, stress", ratio, DEEP, "1", ratio, brief, detail)


def _heat(case: SolvedCase) -> Iterator[LeftOut]:
    """Yield the effect of heat, from the solver's charge of heat (docs/heat.md)."""
    if not np.isfinite(case.charge):
        return
    if case.kind.space:
        yield _unknown(case, "heat", "signal", "K", "heat is not solved for contacts in space")
        return
    start = float(case.factors.get("body_temperature") or FACTORS["body_temperature"].default or 0.0)
    factors = {"touch_temperature": start + WARMER, "hold": case.reading_time, **case.factors}
    rise, hold = abs(float(factors["touch_temperature"]) - start), float(factors["hold"])
    try:
        out = case.solve(factors)
        lacking = str(out.attrs.get("heat", "not known for this body"))
    except (FactorError, MaterialError) as error:
        out, lacking = xr.Dataset(), f"not known: {error}" if case.kind.layered else "solved for films only"
    if "temperature_equal" not in out:
        yield _unknown(case, "heat", "signal", "K", f"heat is {lacking}")
        return
    equal = float(out["temperature_equal"].squeeze())
    share = rise / equal
    arrives = equal < NEVER_TEMPERATURE
    brief = f"heat is {'' if arrives else 'less than '}{_times(share)} the signal"
    detail = f" for {shown(rise, 'K', 3)} in {shown(hold, 's', 2)}"
    if "heat_share" in factors:
        reached = number(100 * float(factors["heat_share"]), 2)
        detail += f", {reached} % of it after {shown(float(out['heat_time'].squeeze()), 's', 2)}"
    part, whose = case.smallest_force / case.force, "the smallest force"
    if not np.isfinite(part):
        part, whose = 1.0, "the signal"
    if arrives:
        detail += f"; {shown(equal, 'K', 2)} equal the signal"
        detail += f", {shown(equal * part, 'K', 2)} {whose}" if part != 1 else ""
    body = {BODY: case.body} if case.body else {}
    uniform = abs(case.length * responses({**case.factors, **body}, out, np.empty(0), case.materials, case.phases)[1])
    if 0 < uniform < np.inf:
        detail += f"; of the whole body {shown(part * case.charge / uniform, 'K', 2)} equal {whose}"
    yield _effect(case, "heat", "signal", rise, equal, "K", share, brief, detail)


def _pad(case: SolvedCase) -> Iterator[LeftOut]:
    """Yield the end of a pad: its solved charge against an endless electrode's; the difference falls as 1/size."""
    endless = case.solved.get("electrode_charge_per_force")
    if endless is None or "patch_size" in case.factors or case.kind.air:
        return
    pad = case.quantities({"patch_size": PAD, "patch": "disc" if case.point else "strip"})
    share = abs(pad["patch_charge_per_force"] / endless - 1)
    brief = f"the end of a pad of {shown(PAD, 'm', 2)} changes the charge by {number(100 * share, 2)} %"
    detail = f"; from {shown(PAD * share / _FEW, 'm', 2)} on it changes by less than {number(100 * _FEW, 2)} %"
    yield _effect(case, "end of the pad", "signal", PAD * share / _FEW, PAD, "m", share, brief, detail)


def _moments_over_charge(case: SolvedCase, stack: Stack, moments: Callable[[Array], Array]) -> float:
    """Return the integral of a base's bending moments, by distance, over the film whose charge is read.

    In air a punch also reads through its gap (docs/heat.md), by the gap's capacitance.
    """
    # the charge is collected by a pad, an electrode without end, or the punch's contact
    pad = SUPPORT if "electrode_charge_per_force" in case.solved else case.half
    pad = min(float(case.factors["patch_size"]) / 2, SUPPORT) if "patch_size" in case.factors else pad
    edges = pad * np.append(np.linspace(0.0, 1.0, 65), np.geomspace(1.0, SUPPORT / pad, 257)[1:])
    r, areas = (edges[1:] + edges[:-1]) / 2, np.diff(np.pi * edges**2 if case.point else 2 * edges)
    is_read_by_punch = "collector" not in case.factors
    radius = case.radius if is_read_by_punch and case.kind.air else None
    gap = Spot("disc" if case.point else "strip", pad, radius=radius).gap(r)
    collected = areas / (1 + gap / max(film_gap(stack), np.finfo(float).tiny)) @ moments(r)
    if not is_read_by_punch or case.kind.air:
        return float(collected)
    shape = {**case.factors, **case.solved} | ({"contact_radius": case.half} if case.point else {})
    return float(collected / areas[gap == 0].sum() * charged_area(shape, stack))


def _bending(case: SolvedCase) -> Iterator[LeftOut]:
    """A base on a ring bends: strain of its surface times the clamped coefficient, over what collects the charge.

    Sum of the moments at r below a force P in the middle of a plate on a ring of radius b: P/4 pi (2 (1 + nu) log(b/r)
    + 1 - nu) (S. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, McGraw-Hill 1959, article 19); of a
    strip on two edges P/2 (b - x) per length. They stretch the surface by 6 (1 - nu)/(E t^2), and 6 (1 - nu^2)/(E t^2).
    """
    stack = case.stack
    if stack is None or isinstance(stack.base, str) or not np.isfinite(case.charge):
        return
    if case.kind.space and case.profile not in ("sphere", "rough_sphere"):
        yield _unknown(case, "bending of the base", "", "m")
        return
    base = stack.base
    poisson = float(base.c12 / (base.c11 + base.c12))
    biaxial = float(base.c11 + base.c12 - 2 * base.c13**2 / base.c33)  # E/(1 - nu) of an isotropic base
    plate = float(base.c11 - base.c13**2 / base.c33)  # E/(1 - nu^2)
    films = [layer.material for layer in stack.layers]
    coefficient = max(abs(float(film.e31 - film.e33 * film.c13 / film.c33)) for film in films)
    if not np.isfinite(biaxial) or not coefficient:
        return

    def moments(r: Array) -> Array:
        if case.point:
            return np.asarray((2 * (1 + poisson) * np.log(SUPPORT / r) + 1 - poisson) / (4 * np.pi))
        return (SUPPORT - r) / 2

    stretched = 6 / (biaxial if case.point else plate) * _moments_over_charge(case, stack, moments)
    thickness = float(np.sqrt(coefficient * stretched * case.force / (_FEW * case.charge)))
    brief = f"a base thinner than {shown(thickness, 'm', 2)} on supports {shown(SUPPORT, 'm', 2)} away bends"
    detail = f", and changes the charge by more than {number(100 * _FEW, 2)} %"
    yield _effect(case, "bending of the base", "", thickness, np.nan, "m", np.nan, brief, detail)


def _roughness(case: SolvedCase) -> Iterator[LeftOut]:
    """Crossed waves of amplitude 2 sigma and wavelength a that a contact flattens add p* = 2 pi E* sigma/a.

    K.L. Johnson, Contact Mechanics, Cambridge 1985, 13.2: p* = pi E* (amplitude)/(wavelength). E* is the contact's own,
    from Hertz's p0 = 2 E* a/(pi R) of a ball and p0 = E* a/(2 R) of a cylinder: so p*/p0 = c sigma R/a^2, c = pi^2 and
    4 pi. Where p* exceeds 3.8 p0 the crests touch apart, each as a ball: p/p0 = (24/pi (p*/p0)^2)^(1/3). An active set
    on a grid gives 1.45 for 1.45, 2.42 for 2.50, 3.70 for 3.99 and 5.8 for 6.5 under a ball.
    """
    if not case.radius:
        yield _unknown(case, "roughness", "stress", "m")
        return
    if case.profile == "rough_sphere":
        yield _unknown(case, "roughness", "stress", "m", "roughness is solved")
        return
    constant = np.pi**2 if case.point and case.profile != "roller" else 4 * np.pi
    double = case.half**2 / (constant * case.radius)
    rms = min(ROUGHNESS, _STEEP * case.half)
    waves = rms / double  # p*/p0
    factor = 1 + waves if waves < _APART else float((24 / np.pi * waves**2) ** (1 / 3))
    brief = f"roughness of {shown(rms, 'm', 2)} raises the largest pressure {_raised('up to ', factor)}"
    detail = f"; {shown(double, 'm', 2)} rms double it"
    if np.isfinite(case.charge):
        moved = 100 * _CHARGE_MOVES * 2 * case.radius * rms / case.half**2
        detail += f"; the charge {f'moves by at most {number(moved, 2)} %' if case.kind.layered else 'does not move'}"
    yield _effect(case, "roughness", "stress", rms, double, "m", factor - 1, brief, detail)


def _tilt(case: SolvedCase) -> Iterator[LeftOut]:
    """A tilted line as slices, each in the contact of a straight line at its own depth.

    With the rise r = a^2/2R of the punch within the contact, a slice at the depth u r has the load u^n and the largest
    pressure u^m (half-plane: 1 and 1/2, by Hertz; thin film: 3/2 and 1). The depth falls by s r along the line, s = 2
    theta/theta_1, theta_1 = a^2/(R L). The load of all slices, the integral of u^n over s, is s. In thick bodies
    slices sink beside each other, so that more of the length stays in contact.
    """
    if case.profile == "roller":
        yield _unknown(case, "tilt", "stress", "rad", "tilt and ends of the roller are solved")
    if case.point:
        return
    if not case.radius:
        yield _unknown(case, "tilt", "stress", "rad")
        return
    n, m = _powers(case) if case.kind.layered else (1.0, 0.5)
    falls = TILT * case.length * case.radius / case.half**2 * 2
    deepest = ((n + 1) * falls) ** (1 / (n + 1))
    if deepest > falls:  # both ends press

        def overload(middle: float) -> float:
            return float((middle + falls / 2) ** (n + 1) - (middle - falls / 2) ** (n + 1)) - (n + 1) * falls

        deepest = float(scipy.optimize.brentq(overload, falls / 2, 2.0)) + falls / 2
    factor, left = deepest**m, min(deepest / falls, 1.0)
    lifting, doubling = (TILT / falls * end for end in ((n + 1) ** (1 / n), 2 ** ((n + 1) / m) / (n + 1)))
    brief = f"a tilt of {shown(TILT, 'rad', 2)} raises the largest pressure {_raised('', factor)}"
    detail = f"; an end of its {shown(case.length, 'm', 3)} lifts at {shown(lifting, 'rad', 2)} or more"
    if left < 1:
        detail += f", and at least {number(100 * left, 2)} % of the length stay in contact"
    stack = case.stack
    if case.read == "charge_per_force" and stack and np.isfinite(case.charge):
        gained = _ENDS * (case.half + sum(layer.thickness for layer in stack.layers))
        gained += _ENDS_IN_AIR * np.sqrt(2 * case.radius * film_gap(stack)) * case.kind.air
        detail += f"; both ends add at most {number(100 * gained / case.length, 2)} % to the charge"
    yield _effect(case, "tilt", "stress", TILT, doubling, "rad", factor - 1, brief, detail)


def _powers(case: SolvedCase) -> tuple[float, float]:
    """Return the powers of the rise within a line's contact by which the load and the largest pressure grow."""
    load = case.kind.loads.force
    larger = replace(case, factors={**case.factors, load: _STEP * float(case.factors[load])})
    rise = 2 * np.log(larger.half / case.half)
    pressures = larger.solved["peak_pressure"] / case.solved["peak_pressure"]
    return float(np.log(_STEP) / rise), float(np.log(pressures) / rise)


def _adhesion(case: SolvedCase) -> Iterator[LeftOut]:
    """Contact of a ball under the load that adhesion adds, and the force that pulls the ball off.

    Soft and large balls: K.L. Johnson, K. Kendall, A.D. Roberts, Proc. R. Soc. A 324 (1971) 301. Others: B.V.
    Derjaguin, V.M. Muller, Y.P. Toporov, J. Colloid Interface Sci. 53 (1975) 314. The number that divides them: D.
    Tabor, J. Colloid Interface Sci. 58 (1977) 2. A film's charge per force becomes that of the wider contact, solved
    under the load that adhesion adds; a half-space's does not change.
    """
    if case.profile != "sphere":
        if case.point:
            yield _unknown(case, "adhesion", "signal" if case.kind.layered else "", "N")
        return
    assert case.radius is not None
    modulus = 3 * case.force * case.radius / (4 * case.half**3)  # by Hertz
    tabor = (case.radius * ADHESION**2 / (modulus**2 * ATOMS**3)) ** (1 / 3)
    pull = (1.5 if tabor > 1 else 2.0) * np.pi * ADHESION * case.radius
    share = pull / case.force
    load = 1 + (2 * share + 2 * np.sqrt(share + share**2) if tabor > 1 else share)
    widened_by = float(load ** (1 / 3) - 1)
    brief, moved_by = f"adhesion widens the contact by {number(100 * widened_by, 2)} %", widened_by
    if case.kind.layered and case.read and np.isfinite(case.charge):
        with suppress(FactorError):  # a contact too wide for the solver
            wider = case.quantities({case.kind.loads.force: load * case.force})
            moved_by = abs(wider[case.read] / case.solved[case.read] - 1)
            brief += f" and changes the charge by {number(100 * moved_by, 2)} %"
    detail = f"; {shown(ADHESION, 'J m-2', 2)} holds the ball with {shown(pull, 'N', 2)}"
    moves = "signal" if case.kind.layered else ""
    yield _effect(case, "adhesion", moves, pull, case.force, "N", moved_by, brief, detail)


def _amplifier(case: SolvedCase) -> Iterator[LeftOut]:
    """A bias current I leaves I R (1 - exp(-t/RC)) at the output after a time t; without a resistance I t/C."""
    if "input_capacitance" not in case.device or not np.isfinite(case.charge):
        return
    device, bias = case.device, case.device.get("bias_current", BIAS)
    feedback = device.get("feedback_capacitance")
    name = next((name for name in _CAPACITANCE if name in case.solved), None)
    contact_capacitance = case.solved[name] * case.length if name else 0.0
    whole = feedback or contact_capacitance + device["input_capacitance"] + device.get("cable_capacitance", 0.0)
    resistance = device.get("feedback_resistance" if feedback else "input_resistance", np.inf)
    signal, time, lasting = case.charge / whole, case.reading_time, resistance * whole
    is_leaky = np.isfinite(resistance)
    left = -bias * resistance * np.expm1(-time / lasting) if is_leaky else bias * time / whole
    brief = f"the bias current adds {_times(left / signal)} the signal in {shown(time, 's', 2)}"
    detail = f"; {shown(bias, 'A', 2)} adds {shown(left, 'V', 2)} where the signal is {shown(signal, 'V', 3)}"
    if is_leaky:
        detail += f", and {shown(bias * resistance, 'V', 2)} in the end (time constant {shown(lasting, 's', 2)})"
    if np.isfinite(case.smallest_force) and bias:
        drift = case.smallest_force / case.force * case.charge / bias
        detail += f"; its charge equals that of the smallest force after {shown(drift, 's', 2)}"
    yield _effect(case, "amplifier", "signal", left, signal, "V", left / signal, brief, detail)


def _mass(case: SolvedCase) -> Iterator[LeftOut]:
    """Weight of a solid ball or cylinder, and its resonance sqrt(k/m)/2 pi on the contact's stiffness.

    A weight of more than a tenth of the force presses too.
    """
    name = str(case.factors.get("punch") or RIGID_PUNCH)
    if name == "skin":  # a hand carries its weight
        return
    if not case.radius:
        yield _unknown(case, "mass of the punch", "signal, stress", "N")
        return
    known = punches().get(name)
    density, body = (known.density, name.replace("_", " ")) if known else (DENSITY, "steel")
    if case.profile == "roller":
        volume = np.pi * case.radius**2 * float(case.factors["length"])
    else:
        volume = 4 / 3 * np.pi * case.radius**3 if case.point else np.pi * case.radius**2 * case.length
    weight = density * volume * GRAVITY
    solved = case.solved
    if weight > _FEW * case.force and case.profile != "rough_sphere":  # whose waves are fitted to its contact
        solved = case.quantities({case.kind.loads.force: (case.force + weight) / case.length})
    brief = f"the punch's weight is {_times(weight / case.force)} the force"
    detail = f"; solid {body} weighs {shown(weight, 'N', 3)} beside {shown(case.force, 'N', 3)}"
    if "contact_stiffness" in solved:
        resonance = np.sqrt(solved["contact_stiffness"] / (density * volume)) / (2 * np.pi)
        detail += f" and rings at {shown(float(resonance), 'Hz', 2)}"
    with suppress(ValueError, KeyError):  # no known limit, or no pressure
        if case.solved["peak_pressure"] <= case.allowable("depoling_stress").value < solved["peak_pressure"]:
            detail += "; with its weight the contact pressure exceeds the depoling stress"
    yield _effect(
        case, "mass of the punch", "signal, stress", weight, case.force, "N", weight / case.force, brief, detail
    )


def _friction(case: SolvedCase) -> Iterator[LeftOut]:
    """Friction slides everywhere in one direction; a press without motion has less tension."""
    slides = float(case.factors.get("friction") or 0) > 0
    if not slides or "trailing_tension" not in case.solved:
        return
    tension = case.solved["trailing_tension"]
    tension_at_rest = case.quantities({"friction": 0.0})["trailing_tension"]
    brief = f"friction slides everywhere, with a tension of {shown(tension, 'Pa', 3)}"
    detail = f"; a press without motion has less, without friction {shown(tension_at_rest, 'Pa', 3)}"
    yield _effect(case, "friction", "", tension, np.nan, "Pa", np.nan, brief, detail)


def _limits(case: SolvedCase) -> Iterator[LeftOut]:
    """Shares of the depoling stress and of the coercive field: constants change from there on."""
    at_amplifier, circuit = case.read_out
    for name, quantity, solved, where in (
        ("depoling_stress", "peak_pressure", case.solved, ""),
        ("coercive_field", "nominal_field", at_amplifier, f"{circuit} the "),
    ):
        try:
            limit = case.allowable(name)
        except ValueError:
            continue
        if quantity in solved:
            size = abs(solved[quantity])
            units = "Pa" if quantity == "peak_pressure" else "V m-1"
            brief = f"{where}{titles.title(quantity)} is {_times(size / limit.value)} the {titles.title(name)}"
            detail = f"; constants change from {shown(limit.value, units, 3)} of {limit.material} on"
            yield _effect(case, titles.title(name), "", size, limit.value, units, np.nan, brief, detail)


def _spark(case: SolvedCase) -> Iterator[LeftOut]:
    """Share of the field at which short gaps of air spark: then charge crosses the gap.

    P.G. Slade, E.D. Taylor, IEEE Trans. Components Packag. Technol. 25 (2002) 390; of polished contacts below 1 um A.
    Peschot et al., Appl. Phys. Lett. 105 (2014) 123109.
    """
    solved, circuit = case.read_out
    size = solved.get("gap_field", 0.0)
    if not size:  # no gap, or nothing that charges it
        return
    brief = f"{circuit} the field beside the contact is {_times(size / SPARK)} that of sparks in short gaps"
    detail = f"; gaps up to 4 µm spark from {shown(SPARK, 'V m-1', 2)} on, polished ones below 1 µm from 350 MV/m"
    yield _effect(case, "spark beside the contact", "", size, SPARK, "V m-1", np.nan, brief, detail)


_BY_SIGNAL = (_constants, _heat, _pad, _bending, _adhesion, _amplifier, _mass)
_BY_STRESS = (_strain, _roughness, _tilt, _friction, _limits, _spark)
