"""The language: names, numbers for people, and a fixed grammar with units and derivatives."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.constants import Boltzmann

from solver import units
from solver.body import KINDS
from solver.names import ALL_QUANTITIES, FACTORS
from solver.units import prefixed
from tests.layers import few_and_many
from tests.workflow.report.browser import in_node, needs_node
from workflow.device.circuit import Circuit
from workflow.language import grammar, statements, statistics
from workflow.language import renamed as module
from workflow.language.constants import CONSTANTS, DEVICE, FIGURES
from workflow.language.expressions import units_of
from workflow.language.numbers import label, number, shown
from workflow.language.renamed import renamed, renamed_study
from workflow.language.spelling import nearest
from workflow.language.wordings import RENAMED, unverified
from workflow.report.page import TEMPLATES


@pytest.mark.parametrize(
    ("value", "digits", "expected"),
    [(5e4, 4, "50000"), (260.4, 2, "260"), (-31960.0, 4, "\N{MINUS SIGN}31960"), (3e5, 4, "3×10⁵"), (0.0, 3, "0"),
     (99999.6, 5, "1×10⁵"), (9.9999e-4, 2, "0.001"), (-1.5e-7, 2, "\N{MINUS SIGN}1.5×10⁻⁷"), (2.5, 1, "3"),
     (float("nan"), 4, "–"), (None, 4, "–")],
)  # fmt: skip
def test_a_number_is_short_and_never_as_programs_write_it(value: float | None, digits: int, expected: str) -> None:
    assert number(value, digits) == expected


@pytest.mark.parametrize(
    ("value", "units", "digits", "expected"),
    [(260.4, "Pa", 2, "260 Pa"), (4.1e-10, "m", 2, "410 pm"), (999.96, "Pa", 4, "1 kPa"),
     (5e4, "N m-1", 4, "50 kN/m"),
     (0.0493, "V m N-1", 4, "49.3 mV·m/N"), (0.67, "1", 4, "0.67"), (2e-3, "kg m-3", 4, "0.002 kg/m³"),
     (3e-9, "m2 s-1", 2, "3000 µm²/s"), (3e-7, "m2", 2, "0.3 mm²"), (2.3e-9, "m2", 2, "2300 µm²"),
     (5.0, "m2", 2, "5 m²"), (np.pi / 4, "rad", 3, "45 deg"), (1e-4, "rad", 3, "100 µrad")],
)  # fmt: skip
def test_a_value_has_a_prefix_where_its_unit_takes_one(value: float, units: str, digits: int, expected: str) -> None:
    assert shown(value, units, digits) == expected


def test_a_label_is_wrapped_and_never_cut() -> None:
    text = "worst-case abs(stroke_per_volt) * 3e5 * (contact_trailing + contact_leading)"
    lines = label(text, "m²/V", 34).splitlines()
    assert " ".join(lines).replace("\N{NO-BREAK SPACE}", " ") == f"{text} [m²/V]"
    assert max(map(len, lines)) <= 34


@needs_node
def test_the_page_writes_numbers_as_python_does(tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    values = [0.0, 2.5, 0.25, 1.25, 999.96, 99999.6, 1e5, 1e-3, 5e4, *(10.0 ** np.arange(-15, 13)).tolist()]
    values += (random.choice([-1, 1], 300) * 10 ** random.uniform(-17, 14, 300)).tolist()
    units = ["Pa", "V m N-1", "1", "m2 s-1", "m2", "T m1/2", "kg m-3", "N m-1 V-1", "s-1", "C m-3/2", "%", "rad"]
    cases = [[value, units[k % len(units)], 1 + k % 6] for k, value in enumerate(values)]
    expected = [[number(v, d), shown(v, u, d), *prefixed(v, u)] for v, u, d in cases]
    script = (TEMPLATES / "numbers.js").read_text(encoding="utf-8")
    written = "cases.map(([v, u, d]) => [digits(v, d), said(v, u, d), engineering(v, u).size, engineering(v, u).units])"
    script += f"const cases = {json.dumps(cases)};"
    assert in_node(script, written, tmp_path) == expected


@pytest.fixture(autouse=True)
def _nothing_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_reported", set())


def test_studies_with_old_names_are_read(capsys: pytest.CaptureFixture[str]) -> None:
    line = {"design": {"d": {"maximise": "abs(voltage_sensitivity) / capacitance"}}, "title": "voltage_sensitivity"}
    expected = {"d": {"maximise": "abs(voltage_per_load) / capacitance_per_length"}}
    for _ in range(2):
        assert renamed_study(line) == {"design": expected, "title": "voltage_sensitivity"}
    first, _ = capsys.readouterr().err.splitlines()  # each name once
    assert first == "voltage_sensitivity is now called voltage_per_load; the old name is read until the next release"
    point = {
        "fixed": {"profile": "sphere"},
        "surrogate": {"outputs": ["contact_capacitance", "capacitance", "charge_sensitivity"]},
        "readout": {"r": {"measured": {"charge_sensitivity": "1 %"}}},
    }
    study = renamed_study(point)
    assert study["surrogate"]["outputs"] == ["capacitance", "capacitance", "charge_per_force"]
    assert study["readout"]["r"]["measured"] == {"charge_per_force": "1 %"}
    capsys.readouterr()
    for fixed in ({"fixed": {"profile": "ball"}}, {"fixd": {"profile": "sphere"}, "factors": {"force": {}}}):
        wanted = {"surrogate": {"outputs": ["capacitance"]}, **fixed}
        assert renamed_study(wanted) == wanted  # not a line's capacitance, for a slip that is refused afterwards
    assert not capsys.readouterr().err


def test_columns_and_options_of_a_quantity_follow_its_name() -> None:
    known = ["voltage_per_load", "capacitance_per_length"]
    assert renamed("capacitance_std", known) == "capacitance_per_length_std"
    assert renamed(["capacitance_gain=3%"], known) == ["capacitance_per_length_gain=3%"]
    assert renamed("charge_sensitivity", known) == "charge_sensitivity"  # whose new name is unknown, too


def test_every_old_name_has_a_new_one_and_every_unit_one_name() -> None:
    assert {*RENAMED.values()} <= ALL_QUANTITIES.keys()
    for name in ALL_QUANTITIES:
        units = {kind.every_quantity[name].units for kind in KINDS.values() if name in kind.every_quantity}
        assert len(units) <= 1


def test_a_name_that_is_half_written_or_old_leads_to_the_present_one() -> None:
    known = [*ALL_QUANTITIES, *DEVICE]
    for name, present in (("voltage_sens", "voltage_per_load"), ("contact_capacitance", "capacitance"),
                          ("feedback_resistence", "feedback_resistance")):  # fmt: skip
        assert f"did you mean {present!r}?" in nearest(name, known)
    balls = [*KINDS["point", True, True].every_quantity, *DEVICE]
    assert "did you mean 'voltage_per_force'?" in nearest("voltage_sens", balls)


NAMES = ["voltage", "magnetic_potential", "load", "radius", "contact_trailing", "peak_pressure"]


def expressions() -> st.SearchStrategy[str]:
    """Texts of the grammar over positive values; products keep them from mixing units."""
    leaf = st.sampled_from(NAMES) | st.floats(0.1, 9).map(lambda value: f"{value:.3f}")
    return st.recursive(
        leaf,
        lambda inner: st.one_of(
            st.tuples(inner, st.sampled_from(["*", "/"]), inner).map(lambda t: f"({t[0]} {t[1]} {t[2]})"),
            st.tuples(inner, st.sampled_from([2, 3, -1])).map(lambda t: f"({t[0]})^{t[1]}"),
            inner.map(lambda t: f"sqrt({t})"),
            inner.map(lambda t: f"abs(-{t})"),
            inner.map(lambda t: f"({t} + 2 * {t})"),
        ),
        max_leaves=8,
    )


def python(text: str, values: dict[str, float]) -> float:
    """The same text as Python reads it: an oracle for the parser, for texts that the strategy above made."""
    code = compile(text.replace("^", "**"), "expression", "eval")
    return float(eval(code, {"__builtins__": {}, "sqrt": math.sqrt, "abs": abs}, values))  # noqa: S307  # own texts only


@few_and_many(50, 400)
@given(expressions(), st.lists(st.floats(0.5, 2.0), min_size=len(NAMES), max_size=len(NAMES)))
def test_values_are_those_of_python_and_derivatives_those_of_differences(text: str, numbers: list[float]) -> None:
    values = dict(zip(NAMES, numbers, strict=True))
    try:
        tree = grammar.parse(text)
    except ValueError as error:
        assert "names no quantity" in str(error)  # noqa: PT017  # a text of numbers only
        return
    value, partials = tree.partials({name: np.array(value) for name, value in values.items()})
    expected = python(text, values)
    assert float(value) == pytest.approx(expected, rel=1e-12)
    assert set(partials) == set(tree.names())
    for name in tree.names():
        step = 1e-5 * values[name]
        high, low = (python(text, {**values, name: values[name] + sign * step}) for sign in (1, -1))
        assert float(partials[name]) == pytest.approx((high - low) / (2 * step), rel=1e-6, abs=1e-7 * abs(expected))


@pytest.mark.parametrize(
    ("text", "value", "unit"),
    [
        ("-voltage^2", -4.0, "V2"),
        ("2 - voltage - 1", -1.0, "V"),
        ("8 / voltage / 2", 2.0, "V-1"),
        ("min(voltage, 5, 3) + max(voltage, 4)", 6.0, "V"),
        ("voltage ** -1", 0.5, "V-1"),
        (" log( exp(friction) ) ", 0.4, "1"),
        ("min(abs(voltage_per_load) / (0.05 V m N-1), 2 * friction)", 0.8, "1"),
        ("voltage/0.5 kV/mm", 4e-6, "m"),  # a number and its unit are one atom
        ("voltage/4 mV/depth", 125.0, "m-1"),  # `depth` is a quantity, no unit
        ("depth + 3um+1", 5.000003, "m"),
        ("depth^2 + 2 µm²", 16.000000000002, "m2"),
        ("depth^2 + 2 um ** 2", 16.000000000002, "m2"),
        ("depth + 5 % * depth", 4.2, "m"),
        ("sqrt(depth / speed)", 2.0, "s1/2"),
    ],
)
def test_expressions_have_their_precedence_and_units(text: str, value: float, unit: str) -> None:
    values = {"voltage": 2.0, "voltage_per_load": -0.05, "friction": 0.4, "depth": 4.0, "speed": 1.0}
    tree = grammar.parse(text)
    assert float(tree.evaluate({k: np.array(v) for k, v in values.items()})) == pytest.approx(value, rel=1e-14)
    assert str(tree.unit()) == unit


def test_names_are_no_units_and_have_one() -> None:
    for name in {**FACTORS, **ALL_QUANTITIES, **CONSTANTS, **FIGURES}:
        with pytest.raises(ValueError, match="not a unit"):
            units.parse(name)
    for text in map(units_of, (*ALL_QUANTITIES, *FACTORS, "copper_thickness")):
        assert units.parse(text).scale == 1.0


OBJECTIVES = [
    ("", "something is missing at its end"),
    ("depth()", "'\\)' is not expected there|'depth' is not a function"),
    ("depth + voltage", "cannot be added \\(unit mismatch\\)"),
    ("__import__('os').system('true')", "'__import__' is not a function"),
    ("abs(depth", "a bracket is not closed"),
    ("depth depth", "'depth' is not expected there"),
    ("1 + 2", "names no quantity"),
    ("depth ^ 0.5", "an exponent must be a whole number"),
    ("exp(depth)", "needs a pure number"),
    ("min(depth)", "takes 2 or more, not 1"),
    ("min(voltage, load, 3) + max(radius, 1)", "cannot be compared \\(unit mismatch\\)"),
    ("(" * 60 + "depth" + ")" * 60, "nested more than 40 deep"),
    ("depth +" * 200 + "depth", "longer than 1000"),
    ("abs(voltage_sensitivty)", "did you mean 'voltage_per_load'"),
    ("depth + 2 Volt", "'Volt' is not a unit; known are"),
    ("depth * 2 N/(V m)", "'V' is a unit, and stands behind a number without brackets"),
    ("depth + 1e308 Tm", "depth \\+ 1e308 Tm': 1e308 Tm is not a finite number"),
]
LIMITS = [
    ("depth", "is not of the form"),
    ("1 < depth < 2", "is not of the form|not expected"),
    ("peak_pressure <= 3 mm depoling_stress", "'m' before depoling_stress: must be a pure number or %"),
    ("peak_pressure <= -1 depoling_stress", "-1 of depoling_stress is no bound"),
    ("depth <= 5 MPa", "unit mismatch: the limit is in MPa, the expression in m"),
    ("depth <= tensile_strength", "unit mismatch: tensile_strength is in Pa, the expression in m"),
    ("depth <= 5 mm with probability 1.2", "probability 1.2 is not from 0.5"),
    ("deviation(depth) >= 2 %", "a deviation takes a positive upper bound"),
    ("depth <= 1e999", "not a finite number"),
]
UNITS = [
    ("V1/0", "'1/0': an exponent must be a whole number from -9 to 9, or one over 2 to 9"),
    ("V٣", "'٣' is not a unit"),
    ("kV9 " * 12, "beyond the range of numbers"),
    ("V " * 60, "a unit of 119 characters is longer than 100"),
]


@pytest.mark.parametrize(
    ("read", "text", "reason"),
    [(statements.objective, *row) for row in OBJECTIVES]
    + [(statements.limit, *row) for row in LIMITS]
    + [(units.parse, *row) for row in UNITS]
    + [(statistics.statistic, "best case", "is not 'worst case', 'mean' or 'mean - K std'")],
)
def test_every_other_text_is_refused(read: Callable[[str], object], text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason) as caught:
        read(text)
    assert "\n" not in str(caught.value)


def test_an_overflow_is_infinite_without_a_warning() -> None:
    values = {"voltage": np.array([1.5]), "friction": np.array([1.5])}
    for text in ("1e308 * voltage + 1e308 * voltage", "(1e308 * voltage)^3", "exp(1e308 * friction)"):
        assert np.isinf(grammar.parse(text).evaluate(values)).all()


@few_and_many(75, 1000)
@given(st.text(max_size=60) | st.lists(st.sampled_from([*NAMES, *"+-*/^()<>=.,1e "])).map("".join))
def test_any_text_is_read_or_refused_in_one_line(text: str) -> None:
    for read in (statements.objective, statements.limit, statistics.statistic, units.parse):
        reader: Any = read
        try:
            reader(text)
        except ValueError as error:
            assert str(error)  # noqa: PT017  # any refusal will do, but no other exception


@pytest.mark.parametrize(
    ("text", "value", "upper", "allowable"),
    [
        ("trailing_tension<5e7", 5e7, True, ""),
        ("abs(voltage) <= -.5", -0.5, True, ""),
        ("trailing_tension <= 50 MPa with probability 0.99", 5e7, True, ""),
        ("depth >= 3 um", 3e-6, False, ""),
        ("deviation(voltage / load) <= 2 %", 0.02, True, ""),
        ("electric_edge_intensity_trailing <= 2 mC m-3/2", 2e-3, True, ""),
        ("nominal_field <= 0.3 coercive_field", 0.3, True, "coercive_field"),
        ("peak_pressure <= 50 % of depoling_stress with probability 0.99", 0.5, True, "depoling_stress"),
        ("base_peak_von_mises <= base_yield_strength", 1.0, True, "base_yield_strength"),
    ],
)
def test_reads_limits_in_si(text: str, value: float, upper: bool, allowable: str) -> None:
    limit = statements.limit(text)
    assert limit.value == pytest.approx(value, rel=1e-14)
    assert limit.upper is upper
    assert limit.probability == (0.99 if "probability" in text else None)
    assert limit.deviation is text.startswith("deviation")
    assert limit.allowable == allowable


def test_figures_of_a_device_are_read_as_their_formulas() -> None:
    text = "abs(signal_voltage) * circuit_capacitance / signal_charge * time_constant / input_resistance"
    tree = grammar.parse(text)
    assert str(tree.unit()) == "F"
    names = {"charge_per_force": 3e-10, "load": 2e4, "electrode_length": 0.01, "capacitance_per_length": 2e-8}
    known = {**names, "input_capacitance": 1e-11, "cable_capacitance": 1e-10, "input_resistance": 1e12}
    value = tree.evaluate({name: np.array(value) for name, value in known.items()})
    assert float(value) == pytest.approx(2e-10 + 1.1e-10, rel=1e-14)
    patches = {"charge_noise": 1e-15, "patch_charge_gradient": -2e-6, "force": 0.5}
    places = {name: np.array(value) for name, value in patches.items()}
    resolution = float(grammar.parse("position_resolution", "point").evaluate(places))
    assert resolution == pytest.approx(2**0.5 * 1e-9)  # two charges have sqrt(2) of a noise
    for name, figure in FIGURES.items():
        assert str(grammar.parse(name).unit()) == str(units.parse(figure.units))


@pytest.mark.parametrize(
    ("text", "deviations"), [("worst case", None), ("mean", 0.0), ("mean - 0 std", 0.0), ("mean - 2.5 std", 2.5)]
)
def test_statistics_of_the_objective(text: str, deviations: float | None) -> None:
    expected = statistics.Worst() if deviations is None else statistics.Mean(deviations)
    assert statistics.statistic(text) == expected


@pytest.mark.parametrize(
    ("unit", "other", "ratio"),
    [("kV/mm", "V m-1", 1e6), ("N m-2", "Pa", 1.0), ("V A", "J s-1", 1.0), ("Wb", "V s", 1.0), ("F V", "C", 1.0),
     ("T m2", "Wb", 1.0), ("g", "kg", 1e-3), ("µm", "nm", 1e3), ("%", "1", 0.01), ("C^2", "A2 s2", 1.0)],
)  # fmt: skip
def test_units_agree_with_the_si_brochure(unit: str, other: str, ratio: float) -> None:
    a, b = units.parse(unit), units.parse(other)
    assert a.fits(b)
    assert a.scale / b.scale == pytest.approx(ratio, rel=1e-14)


def test_a_charge_amplifier_has_its_own_voltage_decay_and_noise() -> None:
    """The output is Q/C_f and decays with R_f C_f; figures agree with the circuit that is solved in time."""
    numbers = {"input_capacitance": 1e-11, "cable_capacitance": 1e-10, "charge_noise": 1e-15, "voltage_noise": 5e-6}
    numbers |= {"feedback_capacitance": 1e-11, "feedback_resistance": 1e13}
    heat = np.sqrt(Boltzmann * 293.15 * 1e-11)
    known = {**numbers, "thermal_energy": 0.0, "feedback_heat": heat, "charge_per_force": 2e-10, "force": 0.2}
    known |= {"capacitance": 4e-12}
    values = {name: np.array(value) for name, value in known.items()}
    names = ("signal_voltage", "time_constant", "smallest_force")
    voltage, decay, force = (grammar.parse(name, "point, charge amplifier").evaluate(values) for name in names)
    assert float(voltage) == pytest.approx(2e-10 * 0.2 / 1e-11, rel=1e-12)
    circuit = Circuit.of(numbers)
    assert float(decay) == pytest.approx(circuit.time_constant(4e-12), rel=1e-4)
    assert float(force) == pytest.approx(circuit.noise(4e-12, 293.15) / 2e-10, rel=1e-12)
    assert float(grammar.parse("signal_voltage", "point").evaluate(values)) == pytest.approx(4e-11 / 1.14e-10)


def test_a_source_that_was_not_read_is_marked() -> None:
    for source in ("a table, recalled", "a value, not read at its source", "somebody's code"):
        assert unverified(source) == " (unverified: not read at its source)"
    assert unverified("a vendor's table") == " (unverified: no dated source)"
    assert unverified("a vendor's table, read in 2026; recalledness is no word of it") == ""
