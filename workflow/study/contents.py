"""Keys of a study's file, and what follows from them: cases, quantities, outputs, materials and hashes."""

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path
from typing import Annotated, Any, Self

import xarray as xr
from pydantic import Field, PrivateAttr

from solver import Material
from solver.body import Kind, around, kind_of, solids
from solver.curves import FOLLOWS
from solver.material.punches import RIGID_PUNCH
from solver.names import AIR, ALL_PEAKS, ALL_QUANTITIES, BODY, CHOICES, HEAT_QUANTITIES, OF_HEAT, SPACE_SLOPES
from workflow.language import titles
from workflow.language.constants import ALLOWABLES, DEVICE, Meeting, meeting_of
from workflow.language.factors import FACTORS
from workflow.study import grouped, layered
from workflow.study.allowable import MADE_OF, Allowable, allowable
from workflow.study.categories import Combination, combinations, output
from workflow.study.sections import (
    Axis,
    DataSet,
    Device,
    Effects,
    Group,
    Measurement,
    Pressing,
    Readout,
    Surrogate,
    Validation,
    Verification,
)
from workflow.study.target import Distribution, Target
from workflow.study.types import BY_FACTOR, Case, CategoryName, FactorName, Strict

#: Sections that decide what a case is and what the solver answers.
PHYSICS = ("phases", "materials", "fixed", "factors", "categories", "body", "groups")
#: Name in `digest` for `PHYSICS` without the numbers of levels.
BOX = "box"


@dataclass(frozen=True)
class Origin:
    """What a study needs beside the content of its file."""

    path: Path
    materials: dict[str, Material]  # the study's own materials by name
    absent: frozenset[str] | None = None  # quantities that some cases lack; None: the solver has yet to say
    hanging: frozenset[str] = frozenset()  # quantities that depend on a datum which is in none of the groups
    in_si: bool = False  # whether the content comes from a checked study, whose numbers are bare and in SI


class Contents(Strict):
    """Everything that a run can be asked for, and what follows from it."""

    title: str = Field(min_length=1, max_length=200, description="headline of the report")
    description: str = Field("", description="what the study is for")
    materials: list[str] = Field([], description="files of own materials, relative to the study")
    phases: Annotated[list[str], Field(min_length=2, max_length=2)] = Field(
        default_factory=lambda: ["BaTiO3", "CoFe2O4"], description="phase one (fibres) and phase two (matrix)"
    )
    fixed: Case = Field({}, description="factors with one value")
    factors: Annotated[dict[FactorName, Axis], BY_FACTOR] = Field({}, description="the axes of the factorial")
    categories: dict[CategoryName, Annotated[list[str], Field(min_length=2, max_length=8)]] = Field(
        {}, description="factors that take one of a few names; every case is solved for each"
    )
    groups: dict[str, Group] = Field(
        {}, description="axes of the data set, each a product of powers of factors, as load * radius / thickness^2"
    )
    body: list[layered.BodyLayer] = Field(
        [], description="layers from the top down, in place of one material and a film's factors"
    )
    dataset: DataSet = Field(default_factory=DataSet, description="what is stored of the factorial")
    surrogate: Surrogate = Field(default_factory=Surrogate, description="the Gaussian process")
    validation: Validation = Field(default_factory=Validation, description="exact cases it never saw")
    device: Device | None = Field(
        None,
        description="what the punch is connected to, for figures of a device; the punch is of steel unless it is "
        "named, and beside it is air unless fixed or categories name surroundings or air lacks what is asked for",
    )
    design: dict[str, Target] = Field({}, description="design targets by name")
    signal: Pressing | None = Field(None, description="a press in time on a design, as its amplifier reads it")
    readout: dict[str, Readout] = Field({}, description="what measurements tell, by name")
    effects: Effects | None = Field(None, description="one factor at a time, as figures")
    verification: Verification | None = Field(None, description="checks of the solver against independent methods")
    measurements: dict[str, Measurement] = Field(
        {},
        max_length=100,
        description="published measurements that the model is held against, by name",
    )

    _origin: Origin = PrivateAttr()
    _absent: frozenset[str] = PrivateAttr(default=frozenset())
    _hanging: frozenset[str] = PrivateAttr(default=frozenset())
    _defaults: tuple[str, ...] = PrivateAttr(default=())

    @property
    def path(self) -> Path:
        """File that the study was read from."""
        return self._origin.path

    @property
    def own_materials(self) -> dict[str, Material]:
        """The study's own materials by name."""
        return self._origin.materials

    @property
    def defaults(self) -> tuple[str, ...]:
        """Defaults that were chosen for the study: a line with the reason for each."""
        return self._defaults

    def tell_default(self, line: str) -> None:
        """Add a line to `defaults`."""
        self._defaults = (*self._defaults, line)

    @property
    def absent(self) -> frozenset[str]:
        """Names of the quantities that some cases lack; none before the solver was asked."""
        return self._absent

    @property
    def kind(self) -> Kind:
        """Kind of body of the cases, which decides their quantities; in air where any case is."""
        factors = self.fixed if self.factors or self.effects is None else {**self.effects.baseline, **self.fixed}
        usual = factors.get("profile", CHOICES["profile"][0])
        profile = self.categories["profile"][0] if "profile" in self.categories else usual
        surroundings = AIR if AIR in self.surroundings else self.surroundings[0]
        named = {*self.factors, *self.categories, *factors, *([BODY] if self.body else [])}
        varied = [name for factor in ("material", "base") for name in self.categories.get(factor, [])]
        materials = [self.own_materials.get(str(name), name) for name in [*solids(factors), *varied]]
        return kind_of(named, profile, surroundings, [*materials, self.body])

    def names(self, factor: str, default: str = "") -> list[str]:
        """Return the names that a factor takes in the cases: its category's, the fixed one or its default."""
        return self.categories.get(factor) or [str(self.fixed.get(factor, default))]

    @property
    def surroundings(self) -> list[str]:
        """Distinct surroundings of the cases: names of the factor ``surroundings``."""
        if self.effects and not self.factors:
            case = {**self.effects.baseline, **self.fixed}
            varied = self.effects.vary.get("surroundings", [case.get("surroundings", around(case))])
            return [str(name) for name in varied]
        return self.names("surroundings", CHOICES["surroundings"][0])

    @property
    def distributions(self) -> dict[str, Distribution]:
        """Distributions of factors by design questions; for each factor the first one."""
        stated = [target.uncertain for target in reversed(self.design.values())]
        return {name: distribution for part in stated for name, distribution in part.items()}

    @property
    def stores_fields(self) -> bool:
        """Return True if the data set holds surface fields, which the page draws."""
        if self.crossed or self.slides:  # no factorial to show them over; the solver takes milliseconds a case
            return False
        # fields in air take as long as the contact
        return not self.kind.air or "positions" in self.dataset.model_fields_set

    @property
    def slides(self) -> bool:
        """Return True if the contacts are points that slide."""
        return self.kind.contact == "point" and ("friction" in self.factors or bool(self.numbers["friction"]))

    @property
    def meeting(self) -> Meeting:
        """Contact and amplifier of the cases, which decide a device's figures; in air if all cases are."""
        reads_charge = bool(self.device and self.device.amplifier and self.device.amplifier.feedback_capacitance)
        if set(self.surroundings) != {AIR}:
            return meeting_of(self.kind.contact, reads_charge=reads_charge)
        return meeting_of("line in air" if self.kind.contact == "line" else "point in air", reads_charge=reads_charge)

    @property
    def elastic(self) -> bool:
        """Return True if a punch on a line deforms: its displacement then has its own datum."""
        numbers = "punch_modulus" in {*self.fixed, *self.factors}
        return self.kind.contact == "line" and (numbers or self.names("punch", RIGID_PUNCH) != [RIGID_PUNCH])

    @property
    def tabled(self) -> list[str]:
        """Axes for each value of which the solver makes tables of films."""
        names = (*self.kind.tabled, *layered.tabled(self.body))
        return [name for name in self.factors if name in names]

    @property
    def axes(self) -> dict[str, Axis]:
        """Axes of the factorial: factors or groups, those with film tables first, so that blocks need few tables."""
        axes = grouped.axes(self.groups, self.factors, self.numbers) if self.groups else self.factors
        return {name: axes[name] for name in dict.fromkeys([*self.tabled, *axes]) if name in axes}

    @property
    def products(self) -> dict[str, grouped.Product]:
        """Products of factors that form the axes of a study with groups."""
        products = {product.name: product for product in map(grouped.product, self.groups)}
        return {name: products[name] for name in self.axes} if products else {}

    @property
    def numbers(self) -> dict[str, float]:
        """Values of numeric factors that are fixed or have a default."""
        usual = {name: factor.default for name, factor in FACTORS.items() if factor.default is not None}
        return usual | {name: value for name, value in self.fixed.items() if not isinstance(value, str)}

    @property
    def crossed(self) -> list[str]:
        """Axes of a cross approximation, those with film tables or all, most levels first; none if not crossed."""
        method, axes = self.surrogate.method, self.axes
        if method == "factorial" or (method == "auto" and self.cases <= self.dataset.budget):
            return []
        return sorted(
            [name for name in self.tabled if name in axes] or axes, key=lambda name: -(axes[name].levels or 0)
        )

    @property
    def costly(self) -> frozenset[str]:
        """Quantities of which a case costs milliseconds: searched for, from tables of its own, or in air."""
        return frozenset(ALL_QUANTITIES if self.tabled or self.kind.air else ALL_PEAKS)

    @property
    def searched(self) -> frozenset[str]:
        """Names of the largest stresses in the data set."""
        peaks = self.dataset.peaks
        return frozenset(peaks if isinstance(peaks, list) else ALL_PEAKS if peaks else ())

    @property
    def cases(self) -> int:
        """Number of cases of the factorial; 0 while some of its levels are open."""
        levels = prod(axis.levels or 0 for axis in self.axes.values()) if self.factors else 0
        return levels * len(self.combinations)

    @property
    def block(self) -> int:
        """Number of cases at a place of the crossed axes."""
        return self.cases // prod(self.axes[name].levels or 1 for name in self.crossed)

    @property
    def combinations(self) -> list[Combination]:
        """Every combination of the categories' names."""
        return combinations(self.categories)

    @property
    def open(self) -> bool:
        """Return True if the pipeline chooses some numbers of levels."""
        return any(axis.levels is None for axis in self.axes.values())

    @property
    def final_files(self) -> list[str]:
        """Last files of a run, under ``results/<study>/``."""
        return ["report.html", "verdict.txt"] if self.verification else ["report.html"]

    @property
    def quantities(self) -> list[str]:
        """Quantities of the data set: those of all its cases, and the peaks that are searched for."""
        lacking = self.absent | (ALL_PEAKS.keys() - self.searched)
        solved = ALL_QUANTITIES if self.asked is None else self.asked
        return [n for n, quantity in ALL_QUANTITIES.items() if n in solved and n not in lacking and not quantity.sparse]

    @property
    def asked(self) -> list[str] | None:
        """Quantities to ask the solver for, None for all: in space only those slopes that are learned."""
        learned = self.surrogate.outputs
        if not (self.kind.space and learned):
            return None
        return [name for name in self.kind.quantities if name in learned or name not in SPACE_SLOPES]

    @property
    def outputs(self) -> list[str]:
        """Quantities that the surrogate learns: those that the study names, or all that need to be learned."""
        # designs compute formulas themselves, and a film's groups do not decide what hangs on the datum
        left_out = (self._hanging - self.added) | {name for name in self.quantities if ALL_QUANTITIES[name].formula}
        return self.surrogate.outputs or [name for name in self.quantities if name not in left_out]

    @property
    def added(self) -> frozenset[str]:
        """Quantities to which the datum's logarithm is added exactly: the depth with groups, under a rigid punch."""
        added = {"depth"} if self.kind.datum == "by_base" and not self.elastic else set()
        return self._hanging & added

    @property
    def regions(self) -> list[str]:
        """Regions with curves that the surrogate learns, for the largest stresses that follow from them."""
        if self.crossed or not self.surrogate.curves or not self.kind.regions:  # points have no such regions
            return []
        followed = [FOLLOWS[name].region for name in self.outputs if name in FOLLOWS]
        return list(dict.fromkeys(followed))

    @property
    def output_names(self) -> list[str]:
        """Names of the surrogate's outputs for every combination of categories."""
        return [output(name, combination) for combination in self.combinations for name in self.outputs]

    @property
    def titles(self) -> dict[str, str]:
        """Title of every target: the study's or its goals', with the target's name where several have one title."""
        words = {name: target.title or titles.wanted(target.objectives) for name, target in self.design.items()}
        several = Counter(words.values())
        return {
            name: f"{word} ({name.replace('_', ' ')})" if several[word] > 1 else word for name, word in words.items()
        }

    @property
    def fixed_of_cases(self) -> dict[str, float | str]:
        """Fixed factors of the solved cases; without those of heat if the surrogate learns nothing of heat."""
        learned = self.surrogate.outputs
        heated = not learned or not HEAT_QUANTITIES.keys().isdisjoint(learned)
        return {name: value for name, value in self.fixed.items() if heated or name not in OF_HEAT}

    def solved(
        self, entrance: Callable[..., xr.Dataset], factors: Mapping[str, Any], *axes: Any, **options: Any
    ) -> xr.Dataset:
        """Solve cases by an entrance of the solver, with this study's body, materials and phases."""
        options |= {"materials": self.own_materials, "phases": self.phases}
        if not self.body:
            return entrance(factors, *axes, **options)
        return layered.solved(self.body, entrance, factors, *axes, **options)

    def held(self, name: str) -> float | str | None:
        """Return the fixed value of a factor, the top layer's number or the default."""
        top = self.body[0].numbers.get(name) if self.body else None
        return self.fixed.get(name, FACTORS[name].default if top is None else top)

    def allowable(self, name: str) -> Allowable:
        """Return the allowable of the top material or the base, of a study whose body has no open category."""
        factors: dict[str, Any] = dict(self.fixed)
        if self.body:
            factors |= {key: value for key, value in self.body[0] if key in MADE_OF and isinstance(value, str | float)}
        return allowable(name, factors, self.own_materials, self.phases)

    def constant(self, name: str) -> float:
        """Return the value of one of ``CONSTANTS``, of a study whose body has no open category."""
        if name in ALLOWABLES:
            return self.allowable(name).value
        constants = self.device.constants if self.device else {}
        if name not in constants:
            part = "device" if name in Device.model_fields else "device: amplifier"
            raise ValueError(f"{part}: {name}: missing; must be a number with a unit [{DEVICE[name].units}]")
        return constants[name]

    def narrowed(self, combination: Mapping[str, str]) -> Self:
        """Return the study with some of its categories held at a name."""
        categories = {name: names for name, names in self.categories.items() if name not in combination}
        return self.model_copy(update={"fixed": {**self.fixed, **combination}, "categories": categories})

    def with_materials(self, materials: Mapping[str, Material]) -> Self:
        """Return the study with other constants of some materials, and the same quantities."""
        copy = self.model_copy()
        copy._origin = replace(self._origin, materials={**self.own_materials, **materials})
        return copy

    def model_post_init(self, origin: Any, /) -> None:
        """Take the origin, which is the context of the validation, before anything is checked."""
        self._origin = origin or Origin(Path(), {})
        for target in self.design.values():
            target.set_meeting(self.meeting)

    def chosen(self, target: Target) -> list[Self]:
        """Return the study for every combination of categories among which a target may choose."""
        allowed = {
            name: (variable.choices or names) if (variable := target.variables.get(name)) else [target.at[name]]
            for name, names in self.categories.items()
        }
        return [
            self.narrowed(combination)
            for combination in self.combinations
            if all(kind in allowed[name] for name, kind in combination.items())
        ]

    def digest(self, *sections: str) -> str:
        """Return a hash of sections or parts, as ``validation.seed``; of own materials too if the physics is in it."""
        names = {name for section in sections for name in (PHYSICS if section == BOX else (section,))}
        plain = self.model_dump(mode="json", include={name.partition(".")[0] for name in names})
        content: dict[str, Any] = {}
        for name in names:
            section, _, part = name.partition(".")
            content[name] = plain[section].get(part) if part else plain[section]
        if BOX in sections:  # random cases do not depend on the numbers of levels
            for axis in (*content["factors"].values(), *content["groups"].values()):
                del axis["levels"]
        # keys of later releases leave the hashes of older studies as they are
        for name in ("body", "groups"):
            if not content.get(name):
                content.pop(name, None)
        if self.surrogate.method == "factorial" and "surrogate" in content:
            content["surrogate"].pop("method")
        text = json.dumps(content, sort_keys=True)
        if {"phases", BOX} & set(sections):
            text += json.dumps(self._plain_materials(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def physics(self) -> str:
        """Hash of `PHYSICS`, by which a surrogate knows its study."""
        return self.digest(*PHYSICS)

    def frozen(self) -> dict[str, Any]:
        """Return the study, its text and its own materials as plain data, from which `thawed` restores the study."""
        return {
            "path": str(self.path),
            "text": self.path.read_text(encoding="utf-8") if self.path.is_file() else "",
            "study": self.model_dump(mode="json"),
            "materials": self._plain_materials(),
            "absent": sorted(self.absent),
            "hanging": sorted(self._hanging),
        }

    def _plain_materials(self) -> dict[str, dict[str, Any]]:
        """Return the constants of own materials; JSON keeps all digits of a float."""
        return {name: material.plain() for name, material in self.own_materials.items()}
