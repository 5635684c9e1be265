"""Signals in time against closed forms: currents, decays and charges of known circuits."""

from typing import Any

import numpy as np
import pytest

import solver
from workflow.device.circuit import Circuit, permittivity
from workflow.device.contact import Contact
from workflow.device.signal import History, read
from workflow.language import grammar
from workflow.study.device import Device

BALL: dict[str, Any] = {"profile": "sphere", "material": "BaTiO3", "radius": 5e-3}
FILM = BALL | {"thickness": 1e-4, "surroundings": "insulated", "base": "rigid"}
LINE: dict[str, Any] = {
    "material": "BaTiO3",
    "radius": 0.05,
    "thickness": 1e-4,
    "surroundings": "insulated",
    "base": "rigid",
}
FORCE = 2.0
PRESS = History(np.array([0.0, 0.1, 1.0]), np.array([0.0, FORCE, FORCE])).finer(10)


@pytest.fixture(scope="module")
def film() -> Contact:
    return Contact.of(FILM, FORCE)


def test_curves_are_the_solvers_between_their_points(film: Contact) -> None:
    forces = np.array([1e-3, 0.03, 0.7, FORCE])
    charge, capacitance = film.at(forces)
    exact = solver.solve(FILM | {"force": forces})
    np.testing.assert_allclose(charge, exact["charge_per_force"].values * forces, rtol=1e-8)
    np.testing.assert_allclose(-charge / capacitance, exact["voltage"].values, rtol=1e-8)  # the open circuit
    np.testing.assert_allclose(capacitance, exact["capacitance"].values, rtol=0.02)
    assert [values.tolist() for values in film.at(np.zeros(1))] == [[0.0], [0.0]]


def test_rates_are_the_derivatives_of_the_curves(film: Contact) -> None:
    forces = np.array([1e-5, 1e-3, 0.1, 1.5])
    step = 1e-5 * forces
    differences = (np.array(film.at(forces + step)) - np.array(film.at(forces - step))) / (2 * step)
    np.testing.assert_allclose(film.rates(forces), differences, rtol=1e-7)


def test_charge_and_capacitance_of_a_line_go_with_its_length() -> None:
    line = Contact.of(LINE, 100.0, length=0.02)
    exact = solver.solve(LINE | {"load": 100.0 / 0.02})
    charge, capacitance = line.at(np.array([100.0]))
    assert charge[0] == pytest.approx(float(exact["charge_per_force"]) * 100.0, rel=1e-8)
    assert capacitance[0] == pytest.approx(0.02 * float(exact["capacitance_per_length"]), rel=0.02)


def test_a_ball_at_constant_speed_gives_a_current_as_v_to_three_halves_and_root_t() -> None:
    """I ~ v^1.5 t^0.5: the depth of a ball at zero volts, v t, goes with P^(2/3) (Sridhar et al. 1999)."""
    half_space = Contact.of(BALL, 10.0)
    stiff = 10.0 / (float(solver.solve(BALL | {"force": 10.0, "total_charge": _charge(10.0)})["depth"]) ** 1.5)
    shunt = Circuit.of({"input_capacitance": 1e-12, "input_resistance": 1.0})
    speeds, currents = np.array([2e-7, 4e-7]), []
    times = np.linspace(0.0, 1.0, 61)
    for speed in speeds:
        found = read(History(times, stiff * (speed * times) ** 1.5), half_space, shunt)
        currents.append(-found.voltage[1:])  # at the end of an interval of constant rate: its mean current
    middles = (times[1:] + times[:-1]) / 2
    faster, slower = np.log(currents[1] / currents[0]), np.polyfit(np.log(middles[9:]), np.log(currents[0][9:]), 1)[0]
    np.testing.assert_allclose(faster / np.log(2), 1.5, atol=1e-5)
    assert slower == pytest.approx(0.5, abs=2e-4)  # chords of sqrt t at a sixtieth of the time


def _charge(force: float) -> float:
    return force * float(solver.solve(BALL | {"force": force})["charge_per_force"])


@pytest.mark.parametrize(
    ("numbers", "lasting"),
    [
        ({"input_capacitance": 1e-11, "cable_capacitance": 1e-10, "input_resistance": 1e9}, 1e9 * 1.1e-10),
        ({"input_capacitance": 1e-11, "feedback_capacitance": 1e-9, "feedback_resistance": 2e8}, 0.2),
    ],
    ids=["voltage", "charge"],
)
def test_a_constant_force_decays_exponentially(film: Contact, numbers: dict[str, float], lasting: float) -> None:
    circuit = Circuit.of(numbers)
    capacitance = float(film.at(np.array([FORCE]))[1][0])
    if not circuit.reads_charge:
        lasting += 1e9 * capacitance
    found = read(PRESS, film, circuit)
    held = PRESS.times >= 0.1
    expected = found.output[held][0] * np.exp(-(PRESS.times[held] - 0.1) / lasting)
    np.testing.assert_allclose(found.output[held], expected, rtol=2e-5, atol=1e-6 * np.abs(expected).max())
    assert circuit.time_constant(capacitance) == pytest.approx(lasting, rel=1e-5)


def test_without_leakage_voltage_and_charge_amplifiers_are_dividers(film: Contact) -> None:
    charge, capacitance = film.at(PRESS.forces)
    voltage = read(PRESS, film, Circuit.of({"input_capacitance": 1e-12})).output
    np.testing.assert_allclose(voltage, -charge / (capacitance + 1e-12), rtol=1e-4, atol=1e-4 * np.abs(voltage).max())
    feedback = {"input_capacitance": 1e-11, "cable_capacitance": 1e-9, "feedback_capacitance": 1e-10}
    output = read(PRESS, film, Circuit.of(feedback)).output
    np.testing.assert_allclose(output, charge / 1e-10, rtol=3e-5, atol=1e-6 * output.max())  # gain 1e6: 1e-5


def test_no_charge_is_lost(film: Contact) -> None:
    """What the node holds is what its resistance has let through, by the trapezoidal rule over the voltage."""
    resistance, capacitance = 1e9, 1e-10
    history = History(np.array([0.0, 0.2, 0.5]), np.array([0.1, FORCE, 0.3])).finer(400)
    found = read(history, film, Circuit.of({"input_capacitance": capacitance, "input_resistance": resistance}))
    through = np.trapezoid(found.voltage / resistance, history.times)
    held = found.charge + capacitance * found.voltage
    assert held[0] - held[-1] == pytest.approx(through, abs=2e-5 * np.abs(held).max())


def test_a_film_leaks_by_its_resistivity_or_its_loss() -> None:
    numbers = {"input_capacitance": 1e-11}
    material = solver.find("BaTiO3")
    leaking = Circuit.of(numbers | {"resistivity": 1e10}, material)
    assert 1 / leaking.leakage == pytest.approx(1e10 * permittivity(material))
    lossy = Circuit.of(numbers | {"loss_tangent": 0.02, "loss_frequency": 50.0})
    assert lossy.time_constant(3e-11) == pytest.approx((3e-11 + 1e-11) / (3e-11 * 2 * np.pi))
    assert Circuit.of(numbers).time_constant(3e-11) == np.inf


def test_noise_is_that_of_amplifier_and_temperature() -> None:
    numbers = {"input_capacitance": 9e-11, "charge_noise": 1e-15, "voltage_noise": 2e-5}
    thermal = 1.380649e-23 * 300 * 1e-10
    assert Circuit.of(numbers).noise(1e-11, 300.0) ** 2 == pytest.approx(
        1e-30 + (2e-5 * 1e-10) ** 2 + thermal, rel=1e-12, abs=0
    )
    figure = grammar.parse("smallest_force")
    device = Device.model_validate(
        {"electrode_length": "1 m", "temperature": "300 K", "amplifier": {**numbers, "charge_noise": "1 fC"}}
    )
    known = device.constants | {"capacitance_per_length": 1e-11, "charge_per_force": -1.0}
    found = figure.evaluate({name: np.array(known[name]) for name in figure.names()})
    assert float(found) == pytest.approx(Circuit.of(numbers).noise(1e-11, 300.0), rel=1e-12, abs=0)
    charge = Circuit.of({"input_capacitance": 9e-11, "feedback_capacitance": 4e-10})
    assert charge.noise(1e-11, 300.0) ** 2 == pytest.approx(4 * thermal, rel=1e-12, abs=0)
    amplifier = {"input_capacitance": 9e-11, "feedback_capacitance": 4e-10, "charge_noise": 0.0}
    device = Device.model_validate({"electrode_length": "1 m", "temperature": "300 K", "amplifier": amplifier})
    known = device.constants | {"capacitance_per_length": 1e-11, "charge_per_force": -1.0}
    found = figure.evaluate({name: np.array(known[name]) for name in figure.names()})
    assert float(found) == pytest.approx(charge.noise(1e-11, 300.0), rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ({"material": "BaTiO3", "radius": 0.05}, "depends on the datum"),
        (LINE | {"base": "steel", "interface_electric": "bonded"}, "depends on the datum"),
        (FILM | {"force": 1.0}, "force: is not the case's"),
        (FILM | {"electric": "insulating"}, "does not conduct"),
        ({"profile": "sphere", "material": "steel", "radius": 5e-3}, "makes no charge"),
    ],
)
def test_contacts_without_a_signal_are_refused(case: dict[str, Any], words: str) -> None:
    with pytest.raises(solver.FactorError, match=words):
        Contact.of(case, FORCE)
