"""The parts of a study: axes, data set, surrogate, effects, verification, read-outs, device, presses, measurements."""

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    model_serializer,
    model_validator,
)

from solver import Material, find
from solver.described import Contact
from solver.material.composite import compose
from solver.names import CHOICES, COMPOSITES, FORMULAS, OF_A_FILM, PROFILES
from solver.units import BOLTZMANN
from workflow.language.constants import DEVICE
from workflow.language.given import number, size
from workflow.study.categories import Combination
from workflow.study.reading import located
from workflow.study.types import (
    BY_FACTOR,
    Case,
    FactorName,
    FieldName,
    Given,
    InputName,
    Number,
    QuantityName,
    Strict,
    Vector,
)

#: Most cases of a factorial.
MOST_CASES = 20_000_000
#: Most corners of a factorial's box, over all categories: the check solves every one.
MOST_CORNERS = 2**18
#: Most values of one field on disk: cases times positions.
MOST_VALUES = 2_000_000_000
#: Most values of one field that are learned, in memory at once: cases times angles.
MOST_LEARNED = 20_000_000
#: Most curves of a figure of effects, points of all of its curves, and points of a grid below the punch.
_MOST_CURVES, _MOST_POINTS, _MOST_GRID = 200, 200_000, 250_000
#: Groups of checks in verification/, in the order of the page.
CHECK_GROUPS = ("limits", "integral_equations", "films", "film_elements", "film_air", "points", "digits")
#: Groups with convergence curves.
CONVERGING = ("integral_equations", "films", "film_elements", "film_air", "points")
#: Quantities of the model to compare with measurements; ``workflow.measured.comparison`` has a function for each.
ModelQuantity = Literal[
    "charge_per_force", "clamped_d33", "free_d33", "indentation_exponent", "response_under_load",
    "stiffness_under_charge", "layer_factor", "pad_stroke_per_volt",
]  # fmt: skip
#: Units of measured values, in SI.
UNITS = {"pC/N": 1e-12, "pm/V": 1e-12, "1": 1.0}

Levels = Annotated[
    int | None, Field(ge=2, le=1000, description="Chebyshev-Gauss levels; null: what the tolerance needs")
]


class Axis(Strict):
    """Range of a factor, sampled at Chebyshev-Gauss levels."""

    low: Given = Field(description="lower end of the range, in SI or with a unit, as 20 um")
    high: Given = Field(description="upper end of the range")
    levels: Levels = None
    scale: Literal["linear", "log", "logit"] = Field("linear", description="coordinate in which the levels are spread")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"low = {self.low:g} must be below high = {self.high:g}")
        if self.scale != "linear" and self.low <= 0:
            raise ValueError(f"low = {self.low:g} must be positive on a {self.scale} scale")
        if self.scale == "logit" and self.high >= 1:
            raise ValueError(f"high = {self.high:g} must be below 1 on a logit scale")
        return self


class Group(Strict):
    """An axis of the data set that is a product of powers of factors, over the range that the box gives it."""

    levels: Levels = None
    scale: Literal["linear", "log", "logit"] | None = Field(
        None,
        description="coordinate in which the levels are spread; null: its one factor's, or log over a decade",
    )


class Positions(Strict):
    """Surface positions of the stored fields, X = (x - c)/h, or r/a of points."""

    inside: int = Field(40, ge=1, le=10_000, description="Chebyshev-Gauss positions under the punch, |X| < 1")
    outside: int = Field(24, ge=0, le=10_000, description="positions beside it, dense near the edges; even")
    reach: Number = Field(4.0, gt=1, le=1e3, description="largest |X|")

    @property
    def count(self) -> int:
        """Number of positions."""
        return self.inside + 2 * (self.outside // 2)

    def values(self) -> Vector:
        """Return the positions X, ascending, (position,); none is -1 or 1."""
        inside = -np.cos(np.pi * (np.arange(self.inside) + 0.5) / self.inside)
        side = self.outside // 2
        outside = 1 + (self.reach - 1) * (np.arange(1, side + 1) / max(side, 1)) ** 2
        return np.concatenate([-outside[::-1], inside, outside])


class DataSet(Strict):
    """Stored part of the factorial."""

    positions: Positions = Field(default_factory=Positions, description="positions of the surface fields")
    slabs: int | None = Field(
        None, ge=1, le=4096, description="files, and jobs, that the factorial is split into; null: one a core"
    )
    precision: Literal["float32", "float64"] = Field("float64", description="stored precision of the surface fields")
    budget: int = Field(
        500_000,
        ge=1,
        le=MOST_CASES,
        description="most cases where the pipeline chooses the levels, or a cross approximation the places",
    )
    peaks: bool | list[QuantityName] = Field(
        False, description="also the largest stresses of the body, all or those that are named: milliseconds a case"
    )

    @model_serializer(mode="wrap")
    def _as_given(self, written: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Return plain data, with positions only where they are given: in air, they ask for fields."""
        content: dict[str, Any] = written(self)
        if "positions" not in self.model_fields_set:
            content.pop("positions", None)
        return content


class Surrogate(Strict):
    """The Gaussian process on the factorial."""

    method: Literal["factorial", "cross", "auto"] = Field(
        "factorial",
        description="cases: all of the factorial, or those places in it that a cross approximation asks for; auto: the "
        "latter where the factorial has more cases than dataset: budget",
    )
    outputs: list[QuantityName] = Field([], description="quantities to learn; empty: every one")
    level: Number | None = Field(
        None, gt=0, le=0.999, description="share of the cases that intervals hold where none is said; null: 0.95"
    )
    curves: bool = Field(
        True, description="learn largest stresses by the curves that they follow from, which have no kinks as they have"
    )
    log: list[QuantityName] | None = Field(
        None,
        description="over groups, quantities whose logarithm is learned; null: those whose coefficients fall faster so",
    )
    fields: int = Field(0, ge=0, le=200, description="angles at which the fields under a cylinder are learned; 0: none")


class Validation(Strict):
    """Exact cases that the surrogate never saw."""

    cases: int = Field(2000, ge=20, le=1_000_000, description="random cases in the box, to measure errors")
    calibration: int = Field(3000, ge=40, le=1_000_000, description="further random cases, to calibrate the intervals")
    seed: int = Field(1, ge=0, description="seed of both samples")
    tolerance: Number = Field(1e-6, gt=0, description="largest error over range that every quantity should keep")


class Interior(Strict):
    """Grid below the punch, in half-widths of the contact, and the fields shown on it."""

    reach: Number = Field(2.5, gt=0, le=1e3, description="largest |x - c|/h")
    depth: Number = Field(2.5, gt=0, le=1e3, description="largest depth over h")
    across: int = Field(161, ge=2, le=2000, description="points across")
    down: int = Field(81, ge=2, le=2000, description="points down, dense near the surface")
    fields: list[FieldName] = Field(
        default_factory=lambda: ["von_mises", "electric_displacement_y", "magnetic_induction_y"],
        min_length=1, description="fields shown as contours",
    )  # fmt: skip

    @model_validator(mode="after")
    def _bounded(self) -> Self:
        if self.across * self.down > _MOST_GRID:
            raise ValueError(f"across x down: {self.across} x {self.down} points are more than {_MOST_GRID}")
        return self

    def grid(self) -> tuple[Vector, Vector]:
        """Return (x - c)/h and y/h < 0, (x,) and (y,)."""
        down = (np.arange(1, self.down + 1) / self.down) ** 1.5
        return np.linspace(-self.reach, self.reach, self.across), -self.depth * down


class Effects(Strict):
    """One factor at a time about a baseline, on the exact solver."""

    baseline: Case = Field(description="factors of the reference case")
    film: Case = Field({}, description="a film for the effects of its own factors, beside the half-plane")
    vary: Annotated[dict[InputName, list[Given] | list[str]], BY_FACTOR] = Field(
        min_length=1, description="values of each factor in turn"
    )
    positions: Positions = Field(
        default_factory=lambda: Positions(inside=200, outside=200), description="positions of the curves"
    )
    interior: Interior | None = Field(None, description="grid of contour plots below the punch")
    realisations: int = Field(
        1, ge=1, le=50, description="random surfaces of a rough sphere over which each effect is repeated"
    )

    @model_validator(mode="after")
    def _bounded(self) -> Self:
        for name, values in self.vary.items():
            if not 1 <= len(values) <= _MOST_CURVES:
                raise ValueError(f"vary: {name}: {len(values)} values; must be 1 to {_MOST_CURVES}, each is a curve")
            positions = self.positions.count
            if len(values) * positions > _MOST_POINTS:
                raise ValueError(
                    f"vary: {name}: {len(values)} values x {positions} positions are more than {_MOST_POINTS}"
                )
        for name in self.film:
            if name not in OF_A_FILM:
                raise ValueError(f"film: {name}: is no factor of a film; allowed: {', '.join(OF_A_FILM)}")
            if name in self.baseline:
                raise ValueError(f"film: {name}: stands in the baseline already; a film there is that of all effects")
        return self

    @property
    def of_baseline(self) -> list[str]:
        """Factors of the baseline that vary."""
        return [name for name in self.vary if name in self.baseline]

    def case(self, factor: str) -> dict[str, Any]:
        """Return the factors of one effect; a material replaces a composite, and a profile leaves factors of others."""
        film = self.film if factor in OF_A_FILM else {}
        around = {"surroundings": CHOICES["surroundings"][0]} if film else {}  # as beside the half-plane
        case: dict[str, Any] = {**around, **self.baseline, **film, factor: self.vary[factor]}
        profiles = case.get("profile", "cylinder")
        known = [str(profile) for profile in np.atleast_1d(profiles) if str(profile) in PROFILES]
        taken = {name for profile in known for name in PROFILES[profile].takes}
        of_others = {name for outline in PROFILES.values() for name in outline.takes} - taken - {factor}
        fractions = dict.fromkeys(COMPOSITES.values())
        composites = np.atleast_1d(case.get("composite", list(COMPOSITES)))
        of_others |= set(fractions) - {COMPOSITES.get(str(kind)) for kind in composites} - {factor}
        alternatives = (
            ({"material"}, {"composite", *fractions}),
            ({"base"}, {"base_modulus", "base_poisson"}),
            ({"punch"}, {"punch_modulus", "punch_poisson"}),
        )
        pairs = [pair for two in alternatives for pair in (two, two[::-1])]
        others = {name for kind, other in pairs if factor in kind for name in other}
        return {name: value for name, value in case.items() if name not in others | of_others}

    def half_plane(self, factor: str) -> dict[str, Any] | None:
        """Return the factors of the half-plane beside the effect of a film's factor; None where there is none."""
        if not self.film or factor not in OF_A_FILM:
            return None
        return {name: value for name, value in self.case(factor).items() if name not in OF_A_FILM}


class Verification(Strict):
    """Checks of the solver against independent methods; they need requirements/dev.txt."""

    cases: int = Field(24, ge=1, le=1000, description="random cases evaluated in 50 digits")
    elements: int = Field(
        24,
        ge=12,
        le=96,
        multiple_of=12,
        description="a sixth and two more is the highest order of the polynomials of finite elements",
    )
    timed: int = Field(4096, ge=100, le=1_000_000, description="cases of the closed form that are timed at once")
    seed: int = Field(1, ge=0, description="seed of the random cases")


class Readout(Strict):
    """Inference of factors from measured quantities, with 95 % intervals."""

    measured: dict[QuantityName, str] = Field(
        min_length=1, description="standard deviation of each measurement: '2 V', or '0.5 %' of the value"
    )
    infer: Annotated[list[FactorName], Field(min_length=1, max_length=3)] = Field(description="factors to infer")
    at: dict[InputName, Number | str] = Field({}, description="the other factors")
    cases: int = Field(500, ge=50, le=100_000, description="random true cases that the intervals are tried on")

    @property
    def combination(self) -> Combination:
        """Categories held at a name."""
        return {name: value for name, value in self.at.items() if isinstance(value, str)}

    @property
    def held(self) -> dict[str, float]:
        """Factors held at a value."""
        return {name: value for name, value in self.at.items() if not isinstance(value, str)}

    @model_validator(mode="after")
    def _readable(self) -> Self:
        for name, text in self.measured.items():
            error(name, text)
        return self


def error(quantity: str, text: str) -> tuple[float, float]:
    """Return a measurement's standard deviation: its absolute part in SI, and its share of the value."""
    with located(f"measured: {quantity}"):
        return size(quantity, text)


def _bounded_below(*, zero_allowed: bool) -> AfterValidator:
    def check(written: float | str, info: ValidationInfo) -> float | str:
        value = number(name := str(info.field_name), written)
        if not (value >= 0 if zero_allowed else value > 0):
            sign = ">=" if zero_allowed else ">"
            raise ValueError(f"{value:g} is not a finite number {sign} 0 [{DEVICE[name].units}]")
        return written

    return AfterValidator(check)


Positive = Annotated[Number | str, _bounded_below(zero_allowed=False)]
NotNegative = Annotated[Number | str, _bounded_below(zero_allowed=True)]


class Amplifier(Strict):
    """Amplifier that reads the charge of the punch; numbers in SI, or with a unit, as ``10 pF``."""

    input_capacitance: Positive = Field(description="of its input [F]")
    input_resistance: Positive | None = Field(None, description="of its input [Ohm]; needed by time_constant")
    cable_capacitance: NotNegative = Field(0.0, description="of the cable [F]")
    charge_noise: NotNegative | None = Field(
        None, description="root mean square in its band, as a charge at its input [C]; needed by smallest_force"
    )
    voltage_noise: NotNegative = Field(0.0, description="root mean square in its band, as a voltage at its input [V]")
    feedback_capacitance: Positive | None = Field(
        None, description="of a charge amplifier, between its output and input [F]; without it, it reads the voltage"
    )
    feedback_resistance: Positive | None = Field(
        None, description="beside the feedback capacitance [Ohm]; infinite by default"
    )
    bias_current: NotNegative | None = Field(
        None, description="that its input draws [A]; it leaves bias_current times the resistance at the output"
    )
    open_loop_gain: Positive = Field(1e6, description="of a charge amplifier without its feedback")


class Device(Strict):
    """Circuit that turns quantities into figures of a device; numbers in SI, or with a unit, as ``10 mm``."""

    electrode_length: Positive | None = Field(
        None,
        description="of the punch along its axis [m]: needed by a line, whose loads are per metre; a point has none",
    )
    drive_voltage: Positive | None = Field(None, description="voltage that drives an actuator [V]")
    amplifier: Amplifier | None = Field(None, description="what reads a sensor")
    temperature: Positive = Field(
        293.15,
        description="of the circuit [K], whose heat is noise: a charge whose square is k T times the capacitance",
    )
    resistivity: Positive | None = Field(
        None, description="of the film [Ohm m], through which charge leaks; infinite by default"
    )
    loss_tangent: NotNegative | None = Field(
        None, description="of the film at loss_frequency, in place of its resistivity"
    )
    loss_frequency: Positive | None = Field(None, description="at which the loss tangent was measured [1/s]")

    def check(self, contact: Contact) -> None:
        """Raise ValueError, in one line, unless lines have a length and points, whose forces are whole, have none."""
        if contact == "line" and self.electrode_length is None:
            raise ValueError("electrode_length: missing; must be a number with a unit [m]")
        if contact == "point" and self.electrode_length is not None:
            raise ValueError("electrode_length: a point contact has none: its forces and charges are whole")

    @property
    def constants(self) -> dict[str, float]:
        """Numbers of the device in SI, by their names in designs."""
        written = {**dict(self), **dict(self.amplifier or {})}
        numbers = {name: number(name, written[name]) for name in DEVICE if written.get(name) is not None}
        energy, feedback = BOLTZMANN * numbers["temperature"], numbers.get("feedback_capacitance", 0.0)
        # what a resistance discharges: all of a circuit, or a charge amplifier's feedback alone
        return numbers | {"thermal_energy": 0.0 if feedback else energy, "feedback_heat": (energy * feedback) ** 0.5}


def _positive(name: str, units: str) -> BeforeValidator:
    def positive(value: object, info: ValidationInfo) -> object:
        if isinstance(value, str | int | float) and not isinstance(value, bool):
            value = number(name, value, units, info.context)
            if not 0 < value < float("inf"):
                raise ValueError(f"{value:g} is not a finite number > 0 [{units}]")
        return value

    return BeforeValidator(positive)


class Pressing(Strict):
    """The punch of a design is pressed, held and let go; numbers in SI or with a unit."""

    study: str = Field("", description="name of the study whose design it is, which stands first; empty: this study")
    design: str = Field(description="the design target whose punch it is")
    force: Annotated[Number, _positive("force", "N")] = Field(description="that is held [N]")
    press: Annotated[Number, _positive("press", "s")] = Field(
        0.1, description="how long pressing takes, and letting go [s]"
    )
    hold: Annotated[Number, _positive("hold", "s")] = Field(10.0, description="how long the force is held [s]")


class ModelValue(Strict):
    """Question to the model, whose answer is compared with a measurement."""

    quantity: ModelQuantity = Field(description="what the model answers with")
    case: Case = Field(
        min_length=1, description="factors of the case, among them a material, or composite AlScN with its fraction"
    )

    @model_validator(mode="after")
    def _of_a_material(self) -> Self:
        if self.quantity == "pad_stroke_per_volt" and (absent := {"collector", "patch_size"} - self.case.keys()):
            raise ValueError(f"case: {min(absent)}: missing; a pad is a patch of an electrode")
        _ = self.material
        return self

    @property
    def material(self) -> Material:
        """Material of the case: from the library, or an alloy of a stated composition."""
        if isinstance(name := self.case.get("material"), str):
            return find(name)
        if (composite := self.case.get("composite")) is None:
            raise ValueError("case: material: missing; every value of the model is one of a material")
        if composite not in FORMULAS:
            raise ValueError(f"case: composite: {composite!r} is not one of {', '.join(FORMULAS)}")
        fraction = self.case.get(COMPOSITES[str(composite)])
        if not isinstance(fraction, float | int):
            raise ValueError(f"case: {COMPOSITES[str(composite)]}: missing; {composite} has a composition")
        return compose(str(composite), (), fraction)


class Measurement(Strict):
    """One row: what was measured, and what the model says to it."""

    of: str = Field(min_length=1, max_length=200, description="what was measured on what")
    short: str = Field("", max_length=40, description="the same in some words, beside its row of the figure")
    value: Number | None = Field(gt=0, description="measured value, in its unit; null: the row is a prediction")
    error: Number | None = Field(None, gt=0, description="standard deviation of it; null: none is published")
    error_is: str = Field("as published", description="where the error comes from")
    unit: Literal["pC/N", "pm/V", "1"] = Field(description="unit of value and error")
    model: list[ModelValue] = Field(
        [], max_length=4, description="the model's value; several, or none, of a row that is open"
    )
    rivals: list[ModelValue] = Field([], max_length=4, description="values of other rules, which the row may rule out")
    open: str = Field("", max_length=300, description="why the row cannot be told, whatever the numbers")
    outside: str = Field("", max_length=300, description="what the model leaves out that the row shows")
    note: str = Field("", max_length=500, description="what else a reader should know of the model's value")
    source: str = Field(min_length=1, max_length=400, description="who measured it, and where it is printed")
    read: Literal["abstract", "table", "quoted"] = Field(
        "abstract", description="where the value was read: the abstract, a vendor's table, another publication"
    )
    decides: str = Field(min_length=1, max_length=300, description="what would decide the row")

    @model_validator(mode="after")
    def _told(self) -> Self:
        if len(self.model) != 1 and not self.open:
            raise ValueError(f"model: {len(self.model)} values; must be one, or `open` must say why the row is open")
        return self
