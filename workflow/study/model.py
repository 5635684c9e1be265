"""The study: one strict model of everything that a run can be asked for."""

import hashlib
import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path
from typing import Annotated, Any, Self

import xarray as xr
from pydantic import Field, PrivateAttr, ValidationError, model_validator

from solver import Material, solve
from solver.curves import FOLLOWS
from solver.film.powerlaw import SMOOTH
from solver.names import ALL_PEAKS, ALL_QUANTITIES, EVERY_FILM_QUANTITY, FILM_PEAKS, OF_A_FILM, PEAKS, TABLED
from solver.similarity import Weight, weight_of
from workflow.language.constants import BORNE, DEVICE
from workflow.language.factors import FACTORS
from workflow.study import datum, grouped, layered
from workflow.study.borne import MADE_OF, Borne, borne
from workflow.study.categories import Kinds, combinations, output
from workflow.study.device import Device
from workflow.study.location import location
from workflow.study.messages import first_problem
from workflow.study.reading import InputError, read_material, read_yaml
from workflow.study.readout import Readout
from workflow.study.sections import (
    MOST_CASES,
    MOST_CORNERS,
    MOST_LEARNED,
    MOST_VALUES,
    Axis,
    DataSet,
    Effects,
    Group,
    Surrogate,
    Validation,
    Verification,
)
from workflow.study.target import Target
from workflow.study.types import CategoryName, FactorName, InputName, Number, Strict

_OF_FILMS = {*OF_A_FILM, *EVERY_FILM_QUANTITY}
_LABEL = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,59}")
_SMOOTH = {"profile": "cylinder", "electric": "conducting", "magnetic": "conducting"}
#: Groups of checks in verification/, in the order of the page.
CHECK_GROUPS = ("limits", "balance", "integral_equations", "finite_elements", "films", "film_elements", "digits")
#: Those with convergence curves.
CONVERGING = ("integral_equations", "finite_elements", "films", "film_elements")
#: Sections that decide what a case is and what the solver answers.
PHYSICS = ("phases", "materials", "fixed", "factors", "categories", "body", "groups")


@dataclass(frozen=True)
class Origin:
    """What a study has beside the content of its file: where that is, and the study's own materials by name.

    Of one that was checked before, also the names of the quantities that some cases lack: of films it costs seconds to
    ask the solver. And those that hang on a datum that is in none of its groups.
    """

    path: Path
    materials: dict[str, Material]
    absent: frozenset[str] | None = None
    hanging: frozenset[str] = frozenset()


class Study(Strict):
    """Everything that a run can be asked for; a study needs ``factors``, ``effects`` or ``verification``."""

    title: str = Field(min_length=1, max_length=200, description="headline of the report")
    description: str = Field("", description="what the study is for")
    materials: list[str] = Field(default_factory=list, description="files of own materials, relative to the study")
    phases: Annotated[list[str], Field(min_length=2, max_length=2)] = Field(
        default_factory=lambda: ["BaTiO3", "CoFe2O4"], description="phase one (fibres) and phase two (matrix)"
    )
    fixed: dict[InputName, Number | str] = Field(default_factory=dict, description="factors with one value")
    factors: dict[FactorName, Axis] = Field(default_factory=dict, description="the axes of the factorial")
    categories: dict[CategoryName, Annotated[list[str], Field(min_length=2, max_length=8)]] = Field(
        default_factory=dict, description="factors that take one of a few names; every case is solved for each"
    )
    groups: dict[str, Group] = Field(
        default_factory=dict,
        description="axes of the data set, each a product of powers of factors, as load * radius / thickness^2",
    )
    body: list[layered.BodyLayer] = Field(
        default_factory=list, description="layers from the top down, in place of one material and a film's factors"
    )
    dataset: DataSet = Field(default_factory=DataSet, description="what is stored of the factorial")
    surrogate: Surrogate = Field(default_factory=Surrogate, description="the Gaussian process")
    validation: Validation = Field(default_factory=Validation, description="exact cases it never saw")
    device: Device | None = Field(None, description="what the punch is connected to, for figures of a device")
    design: dict[str, Target] = Field(default_factory=dict, description="design targets by name")
    readout: dict[str, Readout] = Field(default_factory=dict, description="what measurements tell, by name")
    effects: Effects | None = Field(None, description="one factor at a time, as figures")
    verification: Verification | None = Field(None, description="checks of the solver against independent methods")

    _origin: Origin = PrivateAttr()
    _absent: frozenset[str] = PrivateAttr()
    _hanging: frozenset[str] = PrivateAttr(default=frozenset())

    @property
    def path(self) -> Path:
        """The file that the study was read from."""
        return self._origin.path

    @property
    def own_materials(self) -> dict[str, Material]:
        """The study's own materials by name."""
        return self._origin.materials

    @property
    def on_film(self) -> bool:
        """Whether the cases are films on a base."""
        return bool(self.body) or "thickness" in self.factors or "thickness" in self.fixed

    @property
    def tabled(self) -> list[str]:
        """The axes for whose every value the solver makes tables of films."""
        names = (*TABLED, *layered.tabled(self.body))
        return [name for name in self.factors if self.on_film and name in names]

    @property
    def axes(self) -> dict[str, Axis]:
        """The axes of the factorial in the order of its data set: the factors, or the groups that take their place.

        Of films those come first for which the solver makes tables, so that a block of cases needs few of these.
        """
        own = grouped.axes(self.groups, self.factors, self.numbers) if self.groups else self.factors
        return {name: own[name] for name in dict.fromkeys([*self.tabled, *own]) if name in own}

    @property
    def products(self) -> dict[str, grouped.Product]:
        """What every axis of a study with groups is made of."""
        own = {one.name: one for one in map(grouped.product, self.groups)}
        return {name: own[name] for name in self.axes} if own else {}

    @property
    def numbers(self) -> dict[str, float]:
        """Numeric factors that are fixed, and those with a default."""
        usual = {name: one.default for name, one in FACTORS.items() if one.default is not None}
        return usual | {name: value for name, value in self.fixed.items() if not isinstance(value, str)}

    @property
    def crossed(self) -> list[str]:
        """The axes in which a cross approximation asks for places; none where the whole factorial is solved.

        Those of the most levels come first, where ranks are small.
        """
        if self.surrogate.method == "factorial":
            return []
        return sorted(self.tabled, key=lambda name: -(self.factors[name].levels or 0))

    @property
    def costly(self) -> frozenset[str]:
        """Quantities of which a case costs milliseconds: searched for, or read from tables of the case's own."""
        return frozenset(ALL_QUANTITIES if self.tabled else ALL_PEAKS)

    @property
    def searched(self) -> frozenset[str]:
        """Largest stresses that the data set holds: none, all, or those that are named."""
        asked = self.dataset.peaks
        return frozenset(asked if isinstance(asked, list) else ALL_PEAKS if asked else ())

    @property
    def cases(self) -> int:
        """Number of cases of the factorial; 0 while some of its levels are open."""
        levels = prod(axis.levels or 0 for axis in self.axes.values()) if self.factors else 0
        return levels * len(self.combinations)

    @property
    def block(self) -> int:
        """Number of cases at a place of the crossed axes."""
        return self.cases // prod(self.factors[name].levels or 1 for name in self.crossed)

    @property
    def combinations(self) -> list[Kinds]:
        """Every combination of the categories' names."""
        return combinations(self.categories)

    @property
    def open(self) -> bool:
        """Whether the pipeline is to choose some levels."""
        return any(axis.levels is None for axis in self.axes.values())

    @property
    def final_files(self) -> list[str]:
        """Files under ``results/<study>/`` that a run makes last."""
        return ["report.html", "verdict.txt"] if self.verification else ["report.html"]

    @property
    def quantities(self) -> list[str]:
        """Quantities of the data set: those that its cases have, the peaks where they are asked for."""
        without = self._absent | (ALL_PEAKS.keys() - self.searched)
        return [name for name, one in ALL_QUANTITIES.items() if name not in without and not one.sparse]

    @property
    def outputs(self) -> list[str]:
        """Quantities that the surrogate learns: those that the study names.

        Else all but what designs take from others, and what a film's groups do not tell: see `added`.
        """
        left = (self._hanging - self.added) | {name for name in self.quantities if ALL_QUANTITIES[name].formula}
        return self.surrogate.outputs or [name for name in self.quantities if name not in left]

    @property
    def added(self) -> frozenset[str]:
        """Quantities whose logarithm of the datum is added exactly: of a film's groups, the depth on its base."""
        return frozenset({"depth"} if self.on_film else set()) & self._hanging

    @property
    def regions(self) -> list[str]:
        """Regions of whose curves the surrogate learns, for the largest stresses that follow from them.

        None where it stands on a cross approximation, which knows no largest stresses.
        """
        if self.crossed or not self.surrogate.curves:
            return []
        followed = [FOLLOWS[name].region for name in self.outputs if name in FOLLOWS]
        return list(dict.fromkeys(followed))

    @property
    def learned(self) -> list[str]:
        """What the surrogate calls them: those of every combination of categories."""
        return [output(name, kinds) for kinds in self.combinations for name in self.outputs]

    @property
    def of_interest(self) -> list[str]:
        """What the designs ask for of it, or else all."""
        asked = [name for target in self.design.values() for name in target.names() if name in self.outputs]
        return [output(name, kinds) for name in dict.fromkeys(asked) for kinds in self.combinations] or self.learned

    def solved(
        self, entrance: Callable[..., xr.Dataset], factors: Mapping[str, Any], *axes: Any, **options: Any
    ) -> xr.Dataset:
        """Exact cases by an entrance of the solver: factors of this study's body, materials and phases.

        Parameters
        ----------
        entrance
            `solver.solve` or `solver.solve_interior`; ``axes`` and ``options`` are its own.
        factors
            All factors of the cases; of a body those that its layers name, and its base.
        """
        options |= {"materials": self.own_materials, "phases": self.phases}
        if not self.body:
            return entrance(factors, *axes, **options)
        return layered.solved(self.body, entrance, factors, *axes, **options)

    def held(self, name: str) -> float | str | None:
        """What a factor is fixed at, or a number of the top layer, or its default."""
        top = self.body[0].numbers.get(name) if self.body else None
        return self.fixed.get(name, FACTORS[name].default if top is None else top)

    def bears(self, name: str) -> Borne:
        """What the top material or the base bears, of a study whose body has no open category.

        Raises
        ------
        ValueError
            Nothing is known of it.
        """
        given: dict[str, Any] = dict(self.fixed)
        if self.body:
            given |= {key: value for key, value in self.body[0] if key in MADE_OF and isinstance(value, str | float)}
        return borne(name, given, self.own_materials, self.phases)

    def constant(self, name: str) -> float:
        """One of ``CONSTANTS``, of a study whose body has no open category.

        Raises
        ------
        ValueError
            Nothing is known of it.
        """
        if name in BORNE:
            return self.bears(name).value
        found = self.device.constants if self.device else {}
        if name not in found:
            part = "device" if name in Device.model_fields else "device: amplifier"
            raise ValueError(f"{part}: {name}: missing; must be a number with a unit [{DEVICE[name].units}]")
        return found[name]

    def narrowed(self, kinds: Mapping[str, str]) -> Self:
        """The study with some of its categories held at a name."""
        rest = {name: names for name, names in self.categories.items() if name not in kinds}
        return self.model_copy(update={"fixed": {**self.fixed, **kinds}, "categories": rest})

    def with_materials(self, materials: Mapping[str, Material]) -> Self:
        """The study with other constants under the names of some materials; its quantities stay those that it has."""
        copy = self.model_copy()
        copy._origin = replace(self._origin, materials={**self.own_materials, **materials})
        return copy

    def model_post_init(self, origin: Any, /) -> None:
        """Take what stands beside the file, before anything is checked: the context of the validation."""
        self._origin = origin or Origin(Path(), {})

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if not self.factors and self.effects is None and self.verification is None:
            raise ValueError("factors: a study needs factors, effects or verification")
        self._check_groups()
        self._check_size()
        for name in self.fixed:
            if name in self.factors or name in self.categories:
                part = "factors" if name in self.factors else "categories"
                raise ValueError(f"fixed: {name}: is one of the {part} already")
        if self.dataset.peaks and "base_volume_fraction" in {*self.factors, *self.fixed}:
            raise ValueError("dataset: peaks: are not given of a film that is graded; must be false")
        exponent = self.factors.get("grading_exponent")
        if exponent and exponent.low < SMOOTH:
            raise ValueError(
                f"factors: grading_exponent: {exponent.low:g} to {exponent.high:g} holds values that are not 1, 2, 3 "
                f"or >= {SMOOTH:g} [1]; an axis must be >= {SMOOTH:g}"
            )
        if self.body and not self.factors:
            raise ValueError("body: a study without factors has none")
        layered.check(self.body, self.fixed, {name: (axis.low, axis.high) for name, axis in self.factors.items()})
        for name, names in self.categories.items():
            if len(set(names)) < len(names):
                raise ValueError(f"categories: {name}: {', '.join(names)}: a name is given twice")
        for label in (*self.design, *self.readout):
            if not _LABEL.fullmatch(label):  # names files
                part = "design" if label in self.design else "readout"
                raise ValueError(f"{part}: {label!r} must be letters, digits and underscores, at most 60 of ASCII")
        if self._origin.absent is None:
            self._absent = self._lacked()
            self._solve_effects()
            self._hanging = self._hangs()
        else:
            self._absent, self._hanging = self._origin.absent, self._origin.hanging
        self._check_quantities()
        return self

    def _check_groups(self) -> None:
        """Whether the groups are axes, and cases with the same groups are similar."""
        if not self.groups:
            return
        for name, axis in self.factors.items():
            if axis.levels is not None:
                raise ValueError(f"factors: {name}: levels: of a study with groups they stand in groups")
        products = list(self.products.values())
        grouped.leads(products, self.factors)
        change = grouped.unlike(products, list(self.factors), self._standing())
        if change:
            raise ValueError(grouped.refusal(change))

    def _standing(self) -> dict[str, Weight]:
        """Weights of what does not vary and is not 0: similar cases must leave it alone; without the datum."""
        fixed = {name: value for name, value in self.fixed.items() if not isinstance(value, str) and value}
        layers = {
            f"{kind} {number}": weight_of(kind)
            for number, layer in enumerate(self.body)
            for kind, one in layer.numbers.items()
            if not isinstance(one, str)
        }
        own = {name: weight_of(name) for name in fixed if name != "datum"} | layers
        return {name: weight for name, weight in own.items() if weight != Weight()}

    def _hangs(self) -> frozenset[str]:
        """Quantities that hang on a datum that is in none of the groups; ValueError where they are asked for.

        But of a film the depth, whose logarithm of the datum has one coefficient a base.
        """
        if not self.groups or "datum" in self.factors:
            return frozenset()
        standing = self._standing() | {"datum": weight_of("datum")}
        if grouped.unlike(list(self.products.values()), list(self.factors), standing) is None:
            return frozenset()
        hanging = datum.hanging(self)
        untold = hanging - ({"depth"} if self.on_film else set())
        asked = [name for name in self.surrogate.outputs or ([] if self.on_film else self.quantities) if name in untold]
        if asked:
            raise ValueError(
                f"groups: {', '.join(asked)} hang on the datum, which is in no group: give one with it, as "
                "load * radius / datum^2, or leave them out of surrogate.outputs"
            )
        return hanging

    def _lacked(self) -> frozenset[str]:
        """Names of the quantities that some cases lack, once the solver has answered at the corners of the box.

        Every combination of what needs tables costs a tenth of a second or more: these factors are all at their low
        ends, or all at their high ones.
        """
        if not self.factors:
            return frozenset()
        ends: dict[str, Any] = {name: [axis.low, axis.high] for name, axis in self.factors.items()}
        ends |= {name: xr.DataArray(ends[name], dims="end") for name in self.tabled}
        found = self.solved(solve, {**self.fixed, **self.categories, **ends})
        peaks = set(FILM_PEAKS if self.on_film else PEAKS)
        if "rigid" in self.categories.get("base", [self.fixed.get("base")]):
            peaks -= {name for name in peaks if name.startswith("base_")}
        if len(self.body) > 1:
            peaks -= {name for name in peaks if name.startswith("film_")}
        return frozenset(set(ALL_QUANTITIES) - set(found.data_vars) - peaks)

    def _solve_effects(self) -> None:
        """Whether the solver answers every effect."""
        if self.effects is not None:
            for factor in self.effects.vary:
                solve(self.effects.case(factor), materials=self.own_materials, phases=self.phases)

    def _check_size(self) -> None:
        """Whether what the study asks for can be computed and stored at all."""
        if self.surrogate.method == "cross":
            self._check_crossed()
        elif self.cases > MOST_CASES:
            raise ValueError(f"factors: {self.cases} cases are more than {MOST_CASES}")
        corners = 2 ** len(self.factors) * len(self.combinations)
        if corners > MOST_CORNERS:
            raise ValueError(f"factors: a box of {corners} corners, over all categories, has more than {MOST_CORNERS}")
        if not self.factors:
            return
        cases, positions = self.cases or self.dataset.budget, self.dataset.positions.count
        if self.crossed:
            cases, positions = self.dataset.budget, 1  # without surface fields
        if cases * positions > MOST_VALUES:
            raise ValueError(
                f"dataset: {cases} cases x {positions} positions are more than {MOST_VALUES} values of each field"
            )
        if cases * self.surrogate.fields > MOST_LEARNED:
            raise ValueError(
                f"surrogate: fields: {cases} cases x {self.surrogate.fields} angles are more than {MOST_LEARNED}"
            )

    def _check_crossed(self) -> None:
        """Whether a cross approximation has places to ask for, and a block of cases at each."""
        if not self.tabled:
            raise ValueError("surrogate: method: cross is for films with factors that need tables of their own")
        for name, axis in self.factors.items():
            if axis.levels is None:
                raise ValueError(f"factors: {name}: levels are missing; surrogate: method: cross needs them")
        if self.surrogate.fields or self.surrogate.kernel != "chebyshev":
            raise ValueError("surrogate: method: cross learns no fields, and its kernel is chebyshev")
        if self.groups:
            raise ValueError("groups: surrogate: method: cross stands on the factors themselves, not on groups")
        if self.dataset.peaks:
            raise ValueError("dataset: peaks: surrogate: method: cross learns no largest stresses; must be false")
        if self.block > self.dataset.budget:
            raise ValueError(
                f"factors: {self.block} cases at a place are more than dataset: budget: {self.dataset.budget}"
            )

    def _check_quantities(self) -> None:
        """Whether the data set holds what the surrogate and the designs ask for."""
        for name in self.searched if isinstance(self.dataset.peaks, list) else ():
            if name in self._absent or name not in ALL_PEAKS:
                known = ", ".join(name for name in ALL_PEAKS if name not in self._absent)
                raise ValueError(f"dataset: peaks: these cases have no {name!r}; they have {known}")
        for name in self.surrogate.outputs:
            if name in self._absent or ALL_QUANTITIES[name].sparse:
                raise ValueError(f"surrogate: outputs: some of these cases have no {name!r}")
            if name in ALL_PEAKS.keys() - self.searched:
                raise ValueError(f"surrogate: outputs: {name!r} needs dataset: peaks: true")
        for name in self.surrogate.log or []:
            if not self.groups or name not in self.outputs:
                needs = "is not one of surrogate.outputs" if self.groups else "needs groups"
                raise ValueError(f"surrogate: log: {name!r} {needs}")
        if self.surrogate.fields and self.on_film:
            raise ValueError("surrogate: fields: only those of half-planes are learned")
        if self.surrogate.fields and any(self.fixed.get(name, usual) != usual for name, usual in _SMOOTH.items()):
            raise ValueError("surrogate: fields: only those under a cylinder that conducts in both fields are learned")
        if self.surrogate.fields and self.categories:
            raise ValueError(f"surrogate: fields: are not learned over categories: {', '.join(self.categories)}")
        for label, target in self.design.items():
            self.check_target(f"design: {label}", target)
        for label, readout in self.readout.items():
            self._check_readout(f"readout: {label}", readout)

    def _check_readout(self, where: str, readout: Readout) -> None:
        for name in self.factors:
            if (name in readout.infer) + (name in readout.at) != 1:
                raise ValueError(f"{where}: {name!r} must be either in infer or in at")
        for name in self.categories:
            if name not in readout.at:
                raise ValueError(f"{where}: {name!r} is missing; put it in at")
        for name in readout.infer:
            self.check_values(where, name, [])
        for name, value in readout.at.items():
            self.check_values(where, name, [value])
        for name in readout.measured:
            if name not in self.outputs:
                raise ValueError(f"{where}: {name!r} is not one of surrogate.outputs")

    def check_target(self, where: str, target: Target) -> None:
        """Raise ValueError unless a target asks for every factor once, within its range, and for learned outputs."""
        given = [*target.over, *target.at, *target.worst_case, *target.uncertain]
        for name in given:
            if given.count(name) > 1:
                raise ValueError(
                    f"{where}: {name!r} is given twice; over, at, worst_case and uncertain exclude each other"
                )
            self.check_values(where, name, target.values(name))
        for name in (*self.factors, *self.categories):
            if name not in given:
                places = "over, at, worst_case or uncertain" if name in self.factors else "over or at"
                raise ValueError(f"{where}: {name!r} is missing; put it in {places}")
        for name in target.names():
            if name in FACTORS and name not in self.factors and not isinstance(self.held(name), float | int):
                raise ValueError(f"{where}: {name!r} {self._lack(name) or 'has no value in this study'}")
            if name in ALL_QUANTITIES and name not in self.outputs:
                searched = name in ALL_PEAKS.keys() - self._absent - self.searched
                needs = "needs dataset: peaks: true" if searched else self._lack(name)
                raise ValueError(f"{where}: {name!r} {needs or 'is not one of surrogate.outputs'}")
        for name in target.tolerance:
            self._check_tolerance(f"{where}: tolerance: {name}", name, target)
        for name in target.constants():
            for own in self.chosen(target):
                try:
                    own.constant(name)
                except ValueError as error:
                    raise ValueError(f"{where}: {error}") from None

    def _check_tolerance(self, where: str, name: str, target: Target) -> None:
        """Whether a tolerance leaves values of its variable whose whole tolerance is within the study's range."""
        if name not in self.factors:
            raise ValueError(f"{where}: a category has none")
        axis, given = self.factors[name], target.tolerance[name]
        if target.tolerances[name][1] and axis.low <= 0:
            raise ValueError(f"{where}: {given} of what may be 0 is none; must have a unit [{FACTORS[name].units}]")
        low, high = target.room(name, axis.low, axis.high)
        if name in target.continuous:
            low, high = target.range(name, low, high)
        if not low < high:
            raise ValueError(f"{where}: {given} is larger than the range {axis.low:g} to {axis.high:g} leaves room for")
        for value in target.variables[name].choices:
            if isinstance(value, str) or not low <= value <= high:
                raise ValueError(f"{where}: {given} of {value} is not within {axis.low:g} to {axis.high:g}")

    def _lack(self, name: str) -> str:
        """Why no case has a quantity or factor, where the body is why."""
        return "is a film's: a half-plane has none" if name in _OF_FILMS and not self.on_film else ""

    def chosen(self, target: Target) -> list[Self]:
        """The study for every combination of categories among which a target may choose."""
        allowed = {
            name: (variable.choices or names) if (variable := target.variables.get(name)) else [target.at[name]]
            for name, names in self.categories.items()
        }
        return [
            self.narrowed(kinds)
            for kinds in self.combinations
            if all(kind in allowed[name] for name, kind in kinds.items())
        ]

    def check_values(self, where: str, name: str, values: Sequence[float | str]) -> None:
        """Whether the study has a factor or category, and values are among what it has of it."""
        if name in self.categories:
            for value in values:
                if value not in self.categories[name]:
                    raise ValueError(f"{where}: {name}: {value!r} is not one of {', '.join(self.categories[name])}")
            return
        if name not in self.factors:
            known = ", ".join((*self.factors, *self.categories))
            raise ValueError(f"{where}: {name!r} is not one of the study's factors: {known}")
        axis = self.factors[name]
        for value in values:
            if isinstance(value, str):
                raise ValueError(f"{where}: {name}: {value!r} is not a number")
            if not axis.low <= value <= axis.high:
                end = "low" if value < axis.low else "high"
                told = f"{name} = {value:g} is not within {axis.low:g} to {axis.high:g}"
                raise ValueError(f"{where}: {told}; factors: {name}: {end} says so")

    def digest(self, *sections: str) -> str:
        """Hash of some sections, and of own materials where the physics is among them."""
        content = self.model_dump(mode="json", include=set(sections))
        for name in ("body", "groups"):  # which studies had before there were any
            if not content.get(name):
                content.pop(name, None)
        if self.surrogate.method == "factorial" and "surrogate" in content:  # the same
            content["surrogate"].pop("method")
        text = json.dumps(content, sort_keys=True)
        if "phases" in sections:
            text += json.dumps(self._plain_materials(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def physics(self) -> str:
        """Hash of what decides what a case is and what the solver answers, by which a surrogate knows its study."""
        return self.digest(*PHYSICS)

    def frozen(self) -> dict[str, Any]:
        """The study, its text and its own materials as plain data, from which `thawed` makes the same again."""
        return {
            "path": str(self.path),
            "text": self.path.read_text(encoding="utf-8") if self.path.is_file() else "",
            "study": self.model_dump(mode="json"),
            "materials": self._plain_materials(),
            "absent": sorted(self._absent),
            "hanging": sorted(self._hanging),
        }

    def _plain_materials(self) -> dict[str, dict[str, Any]]:
        """Every constant exactly: JSON gives a float the digits that tell it from its neighbours."""
        return {name: material.plain() for name, material in self.own_materials.items()}


def named(name: str) -> Study:
    """The checked study of a name, wherever its file is.

    Raises
    ------
    InputError
        Also for a name that is unknown or no plain name.
    """
    return load(location(name))


def load(path: str | Path) -> Study:
    """Read and check a study, down to solutions at the corners of its box.

    Raises
    ------
    InputError
        One line that names file, key, value and what is allowed.
    """
    path = Path(path)
    content = read_yaml(path)
    names = content.get("materials")
    known = names if isinstance(names, list) and all(isinstance(name, str) for name in names) else []
    return _made(content, Origin(path, dict(read_material(path.parent / name) for name in known)))


def thawed(frozen: Mapping[str, Any]) -> Study:
    """The study as it was when it was `frozen`; no file is read."""
    materials = {name: Material.from_mapping(entries) for name, entries in frozen["materials"].items()}
    return _made(
        frozen["study"],
        Origin(Path(frozen["path"]), materials, frozenset(frozen["absent"]), frozenset(frozen["hanging"])),
    )


def remade(study: Study, **sections: Any) -> Study:
    """A study with other sections, checked as one that is read from a file.

    Raises
    ------
    InputError
        As `load` does.
    """
    origin = Origin(study.path, study.own_materials)
    return _made(study.model_dump(mode="json") | sections, origin)


def _made(content: dict[str, Any], origin: Origin) -> Study:
    try:
        return Study.model_validate(content, context=origin)
    except ValidationError as error:
        raise InputError(f"{origin.path}: {first_problem(error, Study, content)}") from None
