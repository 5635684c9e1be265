"""Quantities of the heat that a warm punch brings to films, from solved contacts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
import xarray as xr

from solver.arrays import Array
from solver.body import around
from solver.face.factorvalues import absent
from solver.face.filmbodies import OF_A_STACK, stack_of
from solver.face.materials import material_named
from solver.heat.charge import HeatedStack, HeatError, constant, film_gap
from solver.heat.touch import Patch, Shape, Spot, Warmed
from solver.material.constants import Material
from solver.material.punches import RIGID_PUNCH, punches
from solver.names import AIR, BODY, FACTORS, HEAT_QUANTITIES, NEVER_TEMPERATURE, NEVER_TIME, OF_HEAT
from solver.stack.layers import Stack
from solver.units import VACUUM_PERMITTIVITY

#: Factors of the film, of the punch and of the circuit of a case, in addition to those of its stack.
_FACTORS = (
    "thickness", "punch", "profile", "radius", "surroundings", "electric", "collector", "patch", "patch_size",
    "patch_position", "load", "force", *OF_HEAT,
)  # fmt: skip
_CONTACT = ("contact_radius", "contact_trailing", "contact_leading")
_CAPACITANCES = ("capacitance_at_force", "capacitance_at_load", "capacitance", "capacitance_per_length")
_ROUND = ("sphere", "cylinder")
_CHARGES = ("patch_charge_per_force", "electrode_charge_per_force", "charge_per_force")


def with_heat(
    out: xr.Dataset,
    arrays: Mapping[str, xr.DataArray],
    materials: Mapping[str, Material],
    phases: Sequence[str | Material],
) -> xr.Dataset:
    """Return solved contacts with the quantities of heat, or with the reason for their absence, over all factors."""
    charge = next((name for name in _CHARGES if name in out), None)
    factors = [name for name in (*OF_A_STACK, *_FACTORS) if name in arrays]
    contact = [name for name in (*_CONTACT, *_CHARGES) if name in out]
    for name in (name for name in OF_HEAT if name in arrays):
        attrs = {"units": FACTORS[name].units, "long_name": FACTORS[name].long_name}
        out = out.assign_coords({name: (arrays[name].dims, arrays[name].values, attrs)})
    try:
        if charge is None:
            raise HeatError("heat: no electrode is read")
        known = xr.broadcast(
            *(arrays[name].drop_vars(arrays[name].coords) for name in factors),
            *(out[name].reset_coords(drop=True) for name in contact),
        )
        touches = _Touches(materials, phases)
        columns = [array.values.ravel() for array in known]
        rows = (dict(zip((*factors, *contact), row, strict=True)) for row in zip(*columns, strict=True))
        solved = np.array([touches.quantities(row) for row in rows])
    except HeatError as error:
        out = out.assign_attrs(heat=str(error).removeprefix("heat: "))
    else:
        absent_charge = "heat_charge_per_length" if "contact_radius" in out else "heat_charge"
        kinds = [name for name in HEAT_QUANTITIES if name != absent_charge]
        out = out.assign({
            name: (known[0].dims, column.reshape(known[0].shape), HEAT_QUANTITIES[name].attrs)
            for name, column in zip(kinds, solved.T, strict=True)
        })  # fmt: skip
    sizes = {dim: size for array in arrays.values() for dim, size in array.sizes.items()}
    all_factors = xr.DataArray(np.broadcast_to(0.0, tuple(sizes.values())), dims=tuple(sizes))
    broadcast = {name: array.broadcast_like(all_factors) for name, array in out.data_vars.items()}
    return out.assign({name: array.transpose(*sizes, ...) for name, array in broadcast.items()})


@dataclass(frozen=True, eq=False)
class _Touches:
    """Touches of cases, which share stacks, temperatures and times."""

    materials: Mapping[str, Material]
    phases: Sequence[str | Material]
    stacks: dict[Any, tuple[Stack, HeatedStack]] = field(default_factory=dict)
    warmed: dict[Any, Warmed] = field(default_factory=dict)
    times: dict[Any, float] = field(default_factory=dict)  # at which heat overtakes the force, whatever the hold

    def quantities(self, case: Mapping[str, Any]) -> Array:
        """Heat's charge, temperature rise with the force's charge, and time at which heat's charge reaches it; (3,)."""
        key = (
            *(str(case.get(name)) if name != BODY else id(case.get(name)) for name in (*OF_A_STACK, "thickness")),
            case.get("collector"),
        )
        if key not in self.stacks:
            stack = self.stack(case)
            collector = None if "collector" not in case else int(case["collector"])
            self.stacks[key] = stack, HeatedStack.of(stack, collector)
        stack, heated = self.stacks[key]
        leak = case.get("feedback_resistance", np.inf) * case.get("feedback_capacitance", 1.0)
        spot, patch, time = self.spot(case), _patch(case), float(case["hold"])
        if (key, spot, time, leak) not in self.warmed:
            self.warmed[key, spot, time, leak] = heated.warmed(spot, time, leak)
        per_kelvin = heated.collected(self.warmed[key, spot, time, leak], patch)
        rise = case["touch_temperature"] - case.get("body_temperature", FACTORS["body_temperature"].default)
        pressed = next(case[name] for name in _CHARGES if name in case) * case.get("force", case.get("load"))
        left = abs(pressed) * np.exp(-time / leak)
        equal = min(left / abs(per_kelvin), NEVER_TEMPERATURE) if per_kelvin else NEVER_TEMPERATURE
        share = abs(rise) / case.get("heat_share", 1.0)
        time_key = (key, spot, patch, leak, share, pressed)
        if time_key not in self.times:
            self.times[time_key] = heated.overtaken(spot, patch, abs(pressed) / share, leak) if share else NEVER_TIME
        return np.array([rise * per_kelvin, equal, min(self.times[time_key], NEVER_TIME)])

    def stack(self, case: Mapping[str, Any]) -> Stack:
        """Return the stack of one case, with the thermal constants of its materials."""
        if not absent(case.get("base_volume_fraction")):
            raise HeatError("heat: not known for a graded film")
        return stack_of(case, self.materials, self.phases)

    def spot(self, case: Mapping[str, Any]) -> Spot:
        """Return the contact of one case; a rigid or unnamed punch is a perfect conductor."""
        name, punch = case.get("punch", ""), None
        if not (absent(name) or name == RIGID_PUNCH):
            known = punches().get(str(name)) if str(name) not in self.materials else None
            thermal = material_named(name, self.materials).thermal if known is None else known.thermal
            owner = f"the punch {name}"
            punch = constant("conductivity", thermal, owner), constant("heat_capacity", thermal, owner)
        round_in_air = (case.get("surroundings") or around(case)) == AIR and case.get("profile", "cylinder") in _ROUND
        return Spot(*_shape(case), punch, float(case["radius"]) if round_in_air else None)


def _shape(case: Mapping[str, Any]) -> tuple[Shape, float]:
    """Return the shape of a contact, and its radius or half-width [m]."""
    if "contact_radius" in case:
        return "disc", float(case["contact_radius"])
    return "strip", float(case["contact_trailing"] + case["contact_leading"]) / 2


def _patch(case: Mapping[str, Any]) -> Patch | None:
    """Return the patch that collects a case's charge, None for an unbounded electrode or the punch."""
    if "patch_size" not in case:
        return None
    strip = "contact_radius" not in case or case.get("patch", "disc") == "strip"
    return Patch("strip" if strip else "disc", float(case["patch_size"]) / 2, float(case.get("patch_position", 0.0)))


def responses(
    case: Mapping[str, Any],
    solved: xr.Dataset,
    times: Array,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
) -> tuple[Array, float]:
    """Charges per kelvin of a punch at times [s] after it touched, (time,), and of a uniform change [C/K or C/m/K]."""
    touches = _Touches(materials, phases)
    case = {**case, **{name: float(solved[name].squeeze()) for name in (*_CONTACT, *_CAPACITANCES) if name in solved}}
    stack = touches.stack(case)
    heated = HeatedStack.of(stack, None if "collector" not in case else int(case["collector"]))
    spot, patch = touches.spot(case), _patch(case)
    charges = [heated.collected(heated.warmed(spot, time), patch) for time in times]
    return np.array(charges), heated.uniform * charged_area(case, stack)


def charged_area(case: Mapping[str, Any], stack: Stack) -> float:
    """Area of a uniformly polarised film whose charge the electrode collects, infinite if unbounded [m2 or m]."""
    shape, half = _shape(case)
    contact, patch = Spot(shape, half).area, _patch(case)
    if "collector" not in case:  # by reciprocity the punch's charge is its capacitance times the film's open voltage
        capacitance = next((float(case[name]) for name in _CAPACITANCES if name in case), 0.0)
        return max(contact, capacitance * film_gap(stack) / VACUUM_PERMITTIVITY)
    return np.inf if patch is None or patch.shape != shape else Spot(shape, patch.half_width).area
