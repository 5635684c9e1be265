"""Signals in time against closed forms of known circuits, and presses of a study's design on patches."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

import solver
from approximation.arrays import Array
from solver.face.heat import responses
from solver.names import OF_HEAT
from solver.stack.electrodes import Electrode
from solver.stack.layers import Layer, Stack
from storage.netcdf import write_whole
from tests.refusals import assert_refused
from tests.studies import edited, made
from workflow.device import pressed
from workflow.device.circuit import Circuit, permittivity
from workflow.device.contact import ContactCurves
from workflow.device.contact import film as film_of
from workflow.device.signal import History, Warmth, read
from workflow.language import grammar
from workflow.language.numbers import shown
from workflow.report import sentences, tables
from workflow.report.figures import signal_in_time
from workflow.study import load
from workflow.study.model import pressed as pressed_study
from workflow.study.reading import InputError
from workflow.study.sections import Device, Pressing

BALL: dict[str, Any] = {"profile": "sphere", "material": "BaTiO3", "radius": 5e-3}
FILM = BALL | {"thickness": 1e-4, "surroundings": "insulated", "base": "rigid"}
LINE: dict[str, Any] = {
    "material": "BaTiO3", "radius": 0.05, "thickness": 1e-4, "surroundings": "insulated", "base": "rigid",
}  # fmt: skip
FORCE = 2.0
THERMAL = 1.380649e-23 * 300 * 1e-10  # k T C of 100 pF


@pytest.fixture(scope="module")
def film() -> ContactCurves:
    return ContactCurves.from_case(FILM, FORCE)


def test_curves_are_the_solvers_between_their_points(film: ContactCurves) -> None:
    forces = np.array([1e-3, 0.03, 0.7, FORCE])
    charge, capacitance = film.charge(forces), film.capacitance(forces)
    exact = solver.solve(FILM | {"force": forces})
    np.testing.assert_allclose(charge, exact["charge_per_force"].values * forces, rtol=1e-8)
    np.testing.assert_allclose(-charge / capacitance, exact["voltage"].values, rtol=1e-8)  # the open circuit
    np.testing.assert_allclose(capacitance, exact["capacitance"].values, rtol=0.02)
    assert film.charge(np.zeros(1)) == film.capacitance(np.zeros(1)) == 0


AIR = {"profile": "sphere", "material": "PZT-4", "radius": 0.02, "punch": "steel", "thickness": 80e-6, "base": "steel"}
CONTACTS: dict[str, tuple[dict[str, Any], float]] = {  # with the largest relative error of a signal
    "ball in air": (AIR, 5e-3),  # through few contacts, of 0.4 s each
    "ball on a half-space": (BALL, 5e-4),
    "cone": ({"profile": "cone", "material": "PZT-4", "slope": 0.01}, 5e-4),
    "disc": ({k: v for k, v in FILM.items() if k != "radius"} | {"profile": "disc", "width": 2e-4}, 5e-4),
    "line": (LINE, 1e-3),
}
CIRCUITS = {
    "voltage": {"input_capacitance": 1.1e-10, "input_resistance": 1e9},
    "charge": {"input_capacitance": 1e-11, "feedback_capacitance": 1e-11, "feedback_resistance": 1e10},
}


@pytest.mark.parametrize("name", CONTACTS)
def test_a_release_is_that_of_the_circuit_with_solved_contacts(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The node's charge by another method (LSODA), through contacts solved down to a billionth of the force."""
    case, tolerance = CONTACTS[name]
    if case is AIR:
        monkeypatch.setattr("workflow.device.contact._COUNT", 9)
    line = case.get("profile", "cylinder") == "cylinder"
    count, largest = 14 if case is AIR else 90, 20.0 if line else 0.2
    forces = np.concatenate([[0.0], largest * np.geomspace(1e-5 if case is AIR or line else 1e-8, 1, count)])
    solved = solver.solve(case | {"load" if line else "force": forces[1:] / (0.01 if line else 1)})
    charge = np.concatenate([[0.0], np.broadcast_to(solved["charge_per_force"].values, count) * forces[1:]])
    capacitance = -charge[1:] / np.broadcast_to(solved["voltage"].values, count)
    touching = capacitance[0] if case is AIR or name == "disc" else 0.0
    capacitance = np.concatenate([[touching], capacitance])
    history = History(np.array([0.0, 0.1, 2.1, 2.2, 3.0]), largest * np.array([0, 1, 1, 0, 0])).divided(20)
    root = np.cbrt(forces)
    charge_at, capacitance_at = (scipy.interpolate.PchipInterpolator(root, values) for values in (charge, capacitance))
    contact = ContactCurves.from_case(case, largest, length=0.01 if line else 1.0)
    for numbers in CIRCUITS.values():
        circuit = Circuit.of(numbers)
        fed = (1 - circuit.gain) * numbers.get("feedback_capacitance", 0.0) + numbers["input_capacitance"]
        leak = 1 / numbers.get("input_resistance", np.inf)
        leak += (1 - circuit.gain) / numbers.get("feedback_resistance", np.inf)

        def current(time: float, node: Array, fed: float = fed, leak: float = leak) -> Array:
            force = np.cbrt(np.interp(time, history.times, history.forces))
            return np.asarray(-leak * (node - charge_at(force)) / (capacitance_at(force) + fed))

        node = np.zeros(1)
        expected = [0.0]
        for begin, end in pairwise(history.times):
            node = scipy.integrate.solve_ivp(current, (begin, end), node, "LSODA", rtol=1e-8, atol=1e-20).y[:, -1]
            force = np.cbrt(np.interp(end, history.times, history.forces))
            expected.append(float(node[0] - charge_at(force)) / float(capacitance_at(force) + fed))
        voltage = read(history, contact, circuit).voltage
        np.testing.assert_allclose(voltage, expected, rtol=0, atol=tolerance * np.abs(expected).max())
        if case is AIR and not circuit.reads_charge:
            assert np.abs(voltage).max() == pytest.approx(0.2235, abs=1e-4)


def test_a_ball_at_constant_speed_gives_a_current_as_v_to_three_halves_and_root_t() -> None:
    """I ~ v^1.5 t^0.5: the depth of a ball at zero volts, v t, goes with P^(2/3) (Sridhar et al. 1999)."""
    half_space = ContactCurves.from_case(BALL, 10.0)
    charge = 10.0 * float(solver.solve(BALL | {"force": 10.0})["charge_per_force"])
    stiff = 10.0 / float(solver.solve(BALL | {"force": 10.0, "total_charge": charge})["depth"]) ** 1.5
    shunt = Circuit.of({"input_capacitance": 1e-12, "input_resistance": 1.0})
    speeds, currents = np.array([2e-7, 4e-7]), []
    times = np.linspace(0.0, 1.0, 61)
    for speed in speeds:
        reading = read(History(times, stiff * (speed * times) ** 1.5), half_space, shunt)
        currents.append(-reading.voltage[1:])  # at the end of an interval of constant rate: its mean current
    middles = (times[1:] + times[:-1]) / 2
    faster, slower = np.log(currents[1] / currents[0]), np.polyfit(np.log(middles[9:]), np.log(currents[0][9:]), 1)[0]
    np.testing.assert_allclose(faster / np.log(2), 1.5, atol=1e-5)
    assert slower == pytest.approx(0.5, abs=2e-4)  # chords of sqrt t at a sixtieth of the time


def test_a_constant_force_decays_with_the_time_constant_of_its_circuit_and_film() -> None:
    numbers, material = {"input_capacitance": 1e-11}, solver.find("BaTiO3")
    leaking = Circuit.of(numbers | {"resistivity": 1e10}, material)
    assert 1 / leaking.leakage == pytest.approx(1e10 * permittivity(material))
    lossy = Circuit.of(numbers | {"loss_tangent": 0.02, "loss_frequency": 50.0})
    assert lossy.time_constant(3e-11) == pytest.approx((3e-11 + 1e-11) / (3e-11 * 2 * np.pi))
    assert Circuit.of(numbers).time_constant(3e-11) == np.inf
    resistive = Circuit.of({"input_capacitance": 1e-11, "cable_capacitance": 1e-10, "input_resistance": 1e9})
    assert resistive.time_constant(3e-11) == pytest.approx(1e9 * 1.4e-10)
    charge = Circuit.of({"input_capacitance": 1e-11, "feedback_capacitance": 1e-9, "feedback_resistance": 2e8})
    assert charge.time_constant(3e-11) == pytest.approx(0.2, rel=1e-5)


@pytest.mark.parametrize(
    ("numbers", "noise"),
    [
        ({"charge_noise": 1e-15, "voltage_noise": 2e-5}, 1e-30 + (2e-5 * 1e-10) ** 2 + THERMAL),
        ({"charge_noise": 0.0, "feedback_capacitance": 4e-10}, 4 * THERMAL),
    ],
)
def test_noise_is_that_of_amplifier_and_temperature(numbers: dict[str, float], noise: float) -> None:
    numbers = {"input_capacitance": 9e-11, **numbers}
    assert Circuit.of(numbers).noise(1e-11, 300.0) ** 2 == pytest.approx(noise, rel=1e-12, abs=0)
    device = Device.model_validate({"electrode_length": "1 m", "temperature": "300 K", "amplifier": numbers})
    known = device.constants | {"capacitance_per_length": 1e-11, "charge_per_force": -1.0}
    figure = grammar.parse("smallest_force")
    force = figure.evaluate({name: np.array(known[name]) for name in figure.names()})
    assert float(force) == pytest.approx(noise**0.5, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ({"material": "BaTiO3", "radius": 0.05}, "depends on the datum"),
        (LINE | {"base": "steel", "interface_electric": "bonded"}, "depends on the datum"),
        (FILM | {"force": 1.0}, "force: is not the case's"),
        (FILM | {"electric": "insulating"}, "does not conduct"),
        ({"profile": "sphere", "material": "steel", "radius": 5e-3}, "makes no charge"),
        (FILM | {"collector": 1}, "patch_size: missing; an electrode that is read as a whole has no end"),
        (FILM | {"collector": 1, "patch_size": 1e-3, "patch": "strip"}, "patch: 'strip' below a point has no end"),
    ],
)
def test_contacts_without_a_signal_are_refused(case: dict[str, Any], words: str) -> None:
    assert_refused(solver.FactorError, words, ContactCurves.from_case, case, FORCE)


def test_heat_and_bias_current_flow_into_the_node_as_charge_of_a_force_does(film: ContactCurves) -> None:
    """A constant force, heat that grows evenly and a bias current, against the exponential of a constant circuit."""
    numbers = {"input_capacitance": 1e-11, "feedback_capacitance": 1e-11, "feedback_resistance": 1e11}
    history = History(np.linspace(0.0, 3.0, 31), np.full(31, FORCE))
    current, bias = 2e-12, 5e-12
    for numbers_of_case, net in ((numbers, -current), (numbers | {"bias_current": bias}, bias - current)):
        circuit = Circuit.of(numbers_of_case)
        signal = read(history, film, circuit, current * history.times)
        capacitance = float(film.capacitance(np.array([FORCE]))[0]) + circuit.capacitance
        rate = circuit.conductance / capacitance
        stored = -net / rate * np.expm1(-rate * history.times)
        np.testing.assert_allclose(signal.voltage * capacitance, stored, rtol=1e-8, atol=1e-20)
    assert -circuit.gain * bias / circuit.conductance == pytest.approx(bias * 1e11, rel=1e-5)


def test_the_heat_of_a_history_is_a_superposition_of_steps() -> None:
    warm = Warmth(np.array([2.0, 0.1]), np.array([1e-12, -3e-13]), 0.0)
    times = np.array([0.0, 0.5, 0.7, 3.0])
    history = History(times, np.ones(4), np.array([300.0, 310.0, 310.0, 305.0]))

    def step(t: float) -> float:
        return float(-np.expm1(-t * warm.rates) @ warm.sizes)

    for row, time in enumerate(times):
        expected = 0.0
        for begin, end, slope in ((0.0, 0.5, 20.0), (0.7, 3.0, -5 / 2.3)):
            if time > begin:
                expected += slope * quad(lambda u, time=time: step(time - u), begin, min(time, end))[0]
        assert warm.charge(history)[row] == pytest.approx(expected, rel=1e-9, abs=1e-24)


def test_a_film_s_warmth_is_fitted_to_its_steps() -> None:
    case = {**AIR, "base": "steel"}
    history = History(np.array([0.0, 0.1, 0.3, 10.0]), np.full(4, 0.05), np.array([295.0, 306.0, 306.0, 306.0]))
    solved = solver.solve({**case, "force": 0.05})
    warm = Warmth.of_case(case, solved, history, materials={})
    assert warm.error < 5e-4  # the solver is smooth to 3e-4 over a twentieth of the shortest step
    step = History(np.array([0.0, 1e-9, 4.0]), np.zeros(3), np.array([295.0, 296.0, 296.0]))
    expected = responses(case, solved, np.array([4.0]))[0][0]
    assert warm.charge(step)[-1] == pytest.approx(expected, rel=2e-4)

    # warmth that comes evenly, as in a press: the mean of the steps since
    for ramp in (0.1, 0.2, 4.0):
        ages = np.geomspace(1e-6 * ramp, ramp, 60)
        steps = CubicSpline(np.log(ages), responses(case, solved, ages)[0] * ages)
        history = History(np.array([0.0, ramp]), np.zeros(2), np.array([295.0, 296.0]))
        mean = steps.integrate(*np.log(ages[[0, -1]])) / ramp
        assert warm.charge(history)[-1] == pytest.approx(mean, rel=2e-3)


STUDY = """\
title: A finger
body:
  - {material: PDMS, thickness: thickness, below: {electric: grounded}}
  - {material: PVDF, thickness: 5e-5}
fixed: {profile: sphere, radius: 0.01, electric: insulating, magnetic: insulating, base: rigid, collector: 2,
        patch_size: 2e-3}
factors:
  thickness: {low: 5e-4, high: 1e-3, levels: 2}
  force: {low: 0.01, high: 0.1, levels: 2}
surrogate: {outputs: [patch_charge_per_force]}
device: {amplifier: {input_capacitance: 10 pF, feedback_capacitance: 10 pF, charge_noise: 1 fC}}
design: {touch: {maximise: abs(patch_charge_per_force), over: [thickness], at: {force: 0.05}}}
signal: {design: touch, force: 50 mN, hold: 1 s}
"""
PVDF = solver.find("PVDF")
PHASES = ("BaTiO3", "CoFe2O4")
DISC = np.pi * 1e-6  # of 2 mm


def test_a_press_on_a_patch_is_its_charge_over_the_feedback(tmp_path: Path) -> None:
    study = made(STUDY)
    assert isinstance(study.signal, Pressing)
    case = {**study.fixed, "thickness": 7e-4, "force": 0.02}
    press = pressed.signal(study, study.signal, case)
    body = Stack([Layer(solver.find("PDMS"), 7e-4, "grounded"), Layer(PVDF, 5e-5)])
    factors = {name: value for name, value in study.fixed.items() if name != "base"}
    exact = solver.solve({**factors, "surroundings": "insulated", "body": body, "force": [0.05]})
    charge = float(exact["patch_charge_per_force"].squeeze()) * 0.05
    assert float(press["contact_charge"]) == pytest.approx(charge, rel=1e-8)
    held = press["output"].sel(time=slice(0.2, 1.0)).values
    np.testing.assert_allclose(held, charge / 10e-12, rtol=1e-5)  # open-loop gain 1e6
    assert np.isinf(float(press["time_constant"]))
    plates = permittivity(PVDF) * DISC / 5e-5
    assert float(press["capacitance"]) == pytest.approx(plates, rel=1e-12)
    assert float(press["noise_force"]) > 1e-15 / charge * 0.05
    drawn = signal_in_time.figure(press)
    assert [ax.get_ylabel().split()[0] for ax in drawn.axes] == ["force", "output"]
    write_whole(press, tmp_path / "signal.nc")
    said = sentences.signal(tables.signal(tmp_path), "the design 'Charge'")
    assert f"{shown(charge / 10e-12, 'V', 3)} at the output" in said
    assert "no charge leaks. The noise is 1 fC or 100 µV at the output" in said


def test_the_output_of_a_design_is_that_of_its_force_alone() -> None:
    study = load("config/ball.yaml")
    assert study.signal is not None
    case = {**study.fixed, "surroundings": "insulated", "thickness": 110e-6, "radius": 2.5e-3}
    warm = pressed.signal(study, study.signal, case)
    cold = pressed.signal(study, study.signal, {name: value for name, value in case.items() if name not in OF_HEAT})
    assert float(warm["heat_at_end"]) != 0
    assert float(warm["contact_output"]) == float(cold["contact_output"])
    assert "heat_charge" not in study.quantities  # no output is of heat: no case is solved with it


def test_a_voltage_amplifier_on_a_patch_divides_by_its_plates() -> None:
    case = {"material": "PZT-4", "profile": "sphere", "radius": 0.01, "thickness": 1e-4, "base": "rigid"}
    case |= {"electrode": "top", "collector": 2, "patch_size": 1e-3, "magnetic": "insulating"}
    case["surroundings"] = "insulated"
    contact = ContactCurves.from_case(case, 1.0, body=film_of(case | {"force": 1.0}, {}, PHASES)[0])
    forces = np.array([0.0, 1e-6, 1.0])
    charge, capacitance = contact.charge(forces), contact.capacitance(forces)
    material = solver.find("PZT-4")
    np.testing.assert_allclose(capacitance, permittivity(material) * np.pi * 1e-6 / 4 / 1e-4, rtol=1e-12)
    assert charge[2] == pytest.approx(-float(material.e33 / material.c33), rel=0.05)  # nearly all of it is on the disc
    assert contact.roughness < 1e-6


def test_plates_have_a_film_on_each_side_and_a_metal_between() -> None:
    copper, glass = solver.find("copper"), solver.find("glass")
    body = Stack([Layer(PVDF, 1e-5, "grounded"), Layer(glass, 2e-5), Layer(copper, 1e-5), Layer(glass, 4e-5)], "rigid")
    sides = [permittivity(material) / thickness for material, thickness in ((glass, 2e-5), (glass, 4e-5))]
    assert Electrode(body, 2).capacitance == pytest.approx(sum(sides), rel=1e-12)
    assert Electrode(body, 1).capacitance == pytest.approx(sides[0], rel=1e-12)  # the bare film above ends nowhere
    covered = Stack([Layer(PVDF, 1e-5), Layer(glass, 2e-5)], electroded=True)
    in_turn = 1 / (1e-5 / permittivity(PVDF) + 2e-5 / permittivity(glass))
    assert Electrode(covered, 1).capacitance == pytest.approx(in_turn, rel=1e-12)
    graded = {"volume_fraction": 0.5, "base_volume_fraction": 0.8, "thickness": 1e-4, "base": "rigid", "collector": 1}
    graded |= {"profile": "sphere", "radius": 0.01, "force": 1.0}
    with pytest.raises(solver.FactorError, match=r"^base_volume_fraction: 0\.8 of a film whose electrode"):
        film_of(graded, {}, PHASES)


@pytest.mark.parametrize(
    ("named", "words"),
    [
        ("bal", r"mine\.yaml: signal: study: 'bal' is unknown: .*; did you mean 'ball'\?"),
        ("../ball", r"mine\.yaml: signal: '\.\./ball': a study's file must be named with"),
        ("other", r"mine\.yaml: signal: design: 'ball' is not a design target; known are touch"),
    ],
)
def test_designs_of_no_study_are_refused(named: str, words: str, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MEECONTACT_STUDIES", "{}")
    study = edited(STUDY, "signal: {design: touch", f"signal: {{study: {named}, design: ball")
    Path("mine.yaml").write_text(study, encoding="utf-8")
    Path("other.yaml").write_text(STUDY, encoding="utf-8")
    assert_refused(InputError, words, pressed_study, load("mine.yaml"))
