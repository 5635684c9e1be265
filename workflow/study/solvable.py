"""Checks that the solver can answer a study; quantities that its cases lack, or that hang on the datum."""

from collections.abc import Mapping, Sequence
from math import prod
from time import process_time
from typing import Any

import numpy as np
import xarray as xr

from solver import solve
from solver.names import ALL_QUANTITIES, PROFILES
from solver.similarity import Weight, weight_of
from workflow.language.factors import FACTORS
from workflow.language.given import DESTRUCTIVE_PRESSURE
from workflow.study import datum, grouped, representatives
from workflow.study.contents import Contents
from workflow.study.reading import located
from workflow.study.sections import MOST_CASES, MOST_CORNERS, MOST_LEARNED, MOST_VALUES

_SLOW = 20.0  # seconds of the processor for a case, from which on they are reported before a run starts


def check_contact(study: Contents) -> None:
    """Raise ValueError unless all cases have one kind of contact, which suits the device."""
    profiles = study.names("profile")
    if study.design and "map" in profiles:
        raise ValueError("profile: map: designs draw no height map; must be another profile, or effects")
    if len({PROFILES[name].contact for name in profiles if name in PROFILES}) > 1:
        raise ValueError(f"categories: profile: {', '.join(profiles)}: lines and points need a study each")
    if study.device is not None:
        with located("device"):
            study.device.check(study.kind.contact)


def check_groups(study: Contents) -> None:
    """Raise ValueError unless groups form axes over which cases with equal groups are similar."""
    if not study.groups:
        return
    if "power" in study.names("profile"):
        raise ValueError("groups: profile: power: its coefficient scales by its exponent; must be another profile")
    for name, axis in study.factors.items():
        if axis.levels is not None:
            raise ValueError(f"factors: {name}: levels: of a study with groups they stand in groups")
    products = list(study.products.values())
    _check_lone(products)
    grouped.leads(products, study.factors)
    change = grouped.unlike(products, list(study.factors), _standing(study))
    if change:
        also = (
            "; with air beside the contact the gap counts too: make radius / thickness a group"
            if study.kind.air
            else ""
        )
        raise ValueError(grouped.refusal(change) + also)
    grouped.check_signs(products, study.factors, _standing(study))
    _check_cases(study)


def _check_lone(products: Sequence[grouped.Product]) -> None:
    """Raise ValueError for a factor that is a group of its own and in another, where it would be an axis twice."""
    alone = {name for product in products if product.lone for name in product.powers}
    for other in products:
        for name in () if other.lone else alone & other.powers.keys():
            raise ValueError(f"groups: {other.text}: {name!r} is a group of its own; leave it out here")


def _check_cases(study: Contents) -> None:
    """Raise ValueError unless stored cases, which may leave the box of the factors, have allowed factors."""
    for name, values in representatives.ends(study).items():
        for value in np.unique(values):
            if not (np.isfinite(value) and FACTORS[name].allows(value)):
                raise ValueError(
                    f"groups: {name} = {value:g} in a corner of their ranges; must be {FACTORS[name].allowed}"
                )


def _standing(study: Contents) -> dict[str, Weight]:
    """Return the weights of constant numbers but 0 and the datum, which similar cases must share."""
    fixed = {name: value for name, value in study.fixed_of_cases.items() if not isinstance(value, str) and value}
    layers = {
        f"{kind} {number}": weight_of(kind)
        for number, layer in enumerate(study.body)
        for kind, value in layer.numbers.items()
        if not isinstance(value, str)
    }
    weights = {name: weight_of(name) for name in fixed if name != "datum"} | layers
    if study.kind.air:  # the gap scales as the deformation, and the vacuum's constants stay
        weights["gap_permittivity"] = Weight(0.0, 1.0)
    return {name: weight for name, weight in weights.items() if weight != Weight()}


def hanging_on_datum(study: Contents) -> frozenset[str]:
    """Return the quantities that hang on a datum or a radius in none of the groups; ValueError if they are wanted."""
    return _on_datum(study) | _on_punch(study)


def _on_punch(study: Contents) -> frozenset[str]:
    """Return the quantities that hang on an elastic punch's rest radius, where groups do not fix the strength."""
    if not study.groups or not study.elastic or _decided_by_groups(study, {"strength": Weight(0.0, 1.0)}):
        return frozenset()
    hanging = frozenset(name for name, quantity in ALL_QUANTITIES.items() if quantity.on_punch)
    if learned := [name for name in study.surrogate.outputs if name in hanging]:
        raise ValueError(
            f"groups: {', '.join(learned)} depend on an elastic punch's radius beside the groups: make groups of each "
            "length over another and of load over a length, or leave them out of surrogate.outputs"
        )
    return hanging


def _decided_by_groups(study: Contents, fixed: dict[str, Weight]) -> bool:
    """Return True if groups distinguish all cases that are not similar while `fixed` stays."""
    return grouped.unlike(list(study.products.values()), list(study.factors), _standing(study) | fixed) is None


def _on_datum(study: Contents) -> frozenset[str]:
    """Return the quantities that hang on the datum, where groups do not fix it."""
    if not study.groups or "datum" in study.factors or _decided_by_groups(study, {"datum": weight_of("datum")}):
        return frozenset()
    hanging = datum.hanging(study)
    by_base = study.kind.datum == "by_base" and not study.elastic
    # the depth on a film is learned: its logarithm of the datum has one coefficient for each base
    undecided = hanging - ({"depth"} if by_base else set())
    learned = [name for name in study.surrogate.outputs or ([] if by_base else study.quantities) if name in undecided]
    if learned:
        raise ValueError(
            f"groups: {', '.join(learned)} depend on the datum, which is in no group: give one with it, as "
            "load * radius / datum^2, or leave them out of surrogate.outputs"
        )
    return hanging


def lacked(study: Contents) -> frozenset[str]:
    """Solve the corners of the box, and return the names of the quantities that some cases lack."""
    if not study.factors:
        return frozenset()
    began = process_time()
    if study.groups and study.kind.air:
        # in air every corner needs tables: one stored case in each corner of the axes, between which the box lies
        solved = _solve_stored(study, representatives.corners(study))
    else:
        # a table costs a tenth of a second or more: factors that need tables are all low, or all high
        ends: dict[str, Any] = {name: [axis.low, axis.high] for name, axis in study.factors.items()}
        ends |= {name: xr.DataArray(ends[name], dims="end") for name in study.tabled}
        solved = study.solved(solve, {**study.fixed_of_cases, **study.categories, **ends})
        if study.groups:
            _solve_stored(study, representatives.ends(study))
    _report_time(study, process_time() - began)
    _report_pressure(study, solved)
    if "heat" in solved.attrs:
        study.tell_default(f"heat: {solved.attrs['heat']}")
    peaks = set(study.kind.peaks)
    if "rigid" in study.names("base"):
        peaks -= {name for name in peaks if name.startswith("base_")}
    if len(study.body) > 1 or "base_volume_fraction" in {*study.factors, *study.fixed}:
        peaks -= {name for name in peaks if name.startswith("film_")}
    return frozenset(set(ALL_QUANTITIES) - set(solved.data_vars) - peaks)


def _solve_stored(study: Contents, cases: Mapping[str, Any]) -> xr.Dataset:
    """Solve stored cases of a study with groups, which may leave the box of its factors."""
    with located("groups: in a corner of their ranges"):
        return study.solved(solve, {**study.fixed_of_cases, **study.categories, **cases})


def _report_pressure(study: Contents, solved: xr.Dataset) -> None:
    """Report contacts that are pressed beyond every material in all corners of the box: a unit may have been lost."""
    lowest = float(solved["peak_pressure"].min()) if "peak_pressure" in solved else 0.0
    if lowest > DESTRUCTIVE_PRESSURE:
        names = [name for name in (study.kind.loads.force, "radius", "width") if name in {*study.factors, *study.fixed}]
        study.tell_default(
            f"pressure: {lowest / 1e9:.3g} GPa or more in every corner of the box, beyond any material's strength; "
            f"check {' and '.join(names)}: bare numbers are in SI"
        )


def _report_time(study: Contents, seconds: float) -> None:
    """Report, before a run starts, how long its cases take where one takes longer than people wait."""
    corners = 2 if study.tabled else 2 ** len(study.axes)
    seconds_per_case = seconds / (corners * len(study.combinations))
    if seconds_per_case < _SLOW:
        return
    names = study.tabled or list(study.axes)
    levels = prod(study.axes[name].levels or 1 for name in names if name in study.axes)
    unit = "a case with tables of its own" if study.tabled else "a case"
    opened = ", its open numbers of levels counted as 1" if study.open else ""
    count = levels * len(study.combinations)
    study.tell_default(
        f"time: {unit} takes about {seconds_per_case:.0f} s of one core; the {count:,} of the data set{opened} take "
        f"about {count * seconds_per_case / 3600:.2g} h, and random cases for calibration and validation come on top"
    )


def check_fields(study: Contents) -> None:
    """Raise ValueError unless cases have the fields and largest stresses that sections name."""
    effects = study.effects
    if effects and effects.film and study.kind.contact == "point":
        raise ValueError("effects: film: is not drawn of a point; a film stands in the baseline")
    if effects and effects.interior and study.kind.space:
        raise ValueError("effects: interior: of a contact in space is not solved; its maps are drawn without it")
    rough = effects and "rough_sphere" in (effects.baseline.get("profile"), *effects.vary.get("profile", []))
    if effects and effects.realisations > 1 and not rough:
        raise ValueError("effects: realisations: only a rough_sphere has several; must be 1")
    if study.surrogate.fields and (study.kind.air or study.kind.contact == "point"):
        why = "those of contacts with air beside them are not learned" if study.kind.air else "point contacts have none"
        raise ValueError(f"surrogate: fields: {why}; must be 0")


def solve_effects(study: Contents) -> None:
    """Raise an error unless the solver answers every effect."""
    if study.effects is not None:
        for factor in study.effects.vary:
            case = study.effects.case(factor)
            if study.kind.space:  # a case takes half a second
                case[factor] = case[factor][:1]
            solve(case, materials=study.own_materials, phases=study.phases, outputs=["depth"])


def check_size(study: Contents) -> None:
    """Raise ValueError for a study that is too large to compute or store."""
    if study.crossed:
        _check_crossed(study)
    elif study.cases > MOST_CASES:
        raise ValueError(f"factors: {study.cases} cases are more than {MOST_CASES}")
    corners = 2 ** len(study.factors) * len(study.combinations)
    if corners > MOST_CORNERS:
        raise ValueError(f"factors: a box of {corners} corners, over all categories, has more than {MOST_CORNERS}")
    if not study.factors:
        return
    cases = study.dataset.budget if study.crossed else study.cases or study.dataset.budget
    positions = study.dataset.positions.count if study.stores_fields else 1
    if cases * positions > MOST_VALUES:
        raise ValueError(
            f"dataset: {cases} cases x {positions} positions are more than {MOST_VALUES} values of each field"
        )
    if cases * study.surrogate.fields > MOST_LEARNED:
        raise ValueError(
            f"surrogate: fields: {cases} cases x {study.surrogate.fields} angles are more than {MOST_LEARNED}"
        )
    level, held_out = study.surrogate.level, study.validation.calibration
    if level is not None and level > 1 - 2 / (held_out + 1):
        raise ValueError(
            f"surrogate: level: {level:g} is more than {1 - 2 / (held_out + 1):.4g}, all that {held_out} cases of "
            "validation: calibration tell"
        )


def _check_crossed(study: Contents) -> None:
    """Raise ValueError unless a cross approximation has levels, and learns only what it can."""
    for name, axis in study.axes.items():
        if axis.levels is None:
            where = "groups" if study.groups else "factors"
            raise ValueError(f"{where}: {name}: levels are missing; surrogate: method: cross needs them")
    if study.surrogate.fields:
        raise ValueError("surrogate: method: cross learns no fields; fields must be 0")
    if study.dataset.peaks:
        raise ValueError("dataset: peaks: surrogate: method: cross learns no largest stresses; must be false")
    if study.block > study.dataset.budget:
        raise ValueError(
            f"factors: {study.block} cases at a place are more than dataset: budget: {study.dataset.budget}"
        )
