"""A press in time on a study's design, and the patch that is read, against plates and dividers of charge."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import solver
from solver.stack.electrodes import Electrode
from solver.stack.layers import Layer, Stack
from storage.netcdf import write_whole
from tests.studies import edited, made, refusal
from workflow.design.verdict.leftout import LeftOut
from workflow.device import pressed
from workflow.device.circuit import permittivity
from workflow.device.contact import ContactCurves, film
from workflow.language import numbers
from workflow.report import firstscreen as report
from workflow.report import sentences, tables
from workflow.report.figures import signal_in_time
from workflow.study import signal_case
from workflow.study.sections import Pressing

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
DISC = np.pi * 1e-6  # of 2 mm


def test_a_press_on_a_patch_is_its_charge_over_the_feedback(tmp_path: Path) -> None:
    study = made(STUDY)
    assert isinstance(study.signal, Pressing)
    case = {**study.fixed, "thickness": 7e-4, "force": 0.02}
    shown = pressed.signal(study, study.signal, case)
    body = Stack([Layer(solver.find("PDMS"), 7e-4, "grounded"), Layer(PVDF, 5e-5)])
    factors = {name: value for name, value in study.fixed.items() if name != "base"}
    exact = solver.solve({**factors, "surroundings": "insulated", "body": body, "force": [0.05]})
    charge = float(exact["patch_charge_per_force"].squeeze()) * 0.05
    assert float(shown["contact_charge"]) == pytest.approx(charge, rel=1e-8)
    held = shown["output"].sel(time=slice(0.2, 1.0)).values
    np.testing.assert_allclose(held, charge / 10e-12, rtol=1e-5)  # open-loop gain 1e6
    assert np.isinf(float(shown["time_constant"]))
    plates = permittivity(PVDF) * DISC / 5e-5
    assert float(shown["capacitance"]) == pytest.approx(plates, rel=1e-12)
    assert float(shown["noise_force"]) > 1e-15 / charge * 0.05
    drawn = signal_in_time.figure(shown)
    assert [ax.get_ylabel().split()[0] for ax in drawn.axes] == ["force", "output"]
    write_whole(shown, tmp_path / "signal.nc")
    said = sentences.signal(tables.signal(tmp_path), "the design 'Charge'")
    assert said.startswith("50 mN on the design 'Charge' gives ")
    assert f"{numbers.shown(charge / 10e-12, 'V', 3)} at the output" in said
    assert "no charge leaks. The noise is 1 fC or 100 µV at the output" in said
    press = tables.signal(tmp_path)
    shares = {1e-7: "less than 0.01 %", 0.078: "7.8 %"}
    for share, words in shares.items():
        warm = sentences.signal({**press, "heat_at_end": share * press["contact_charge"]}, "the design 'Charge'")
        assert warm.endswith(f"Heat of what touches makes {words} of the charge of the force by the end of the hold.")


COATED: dict[str, Any] = {
    "material": "PZT-4", "profile": "sphere", "radius": 0.01, "thickness": 1e-4, "surroundings": "insulated",
    "base": "rigid",
}  # fmt: skip


def test_a_voltage_amplifier_on_a_patch_divides_by_its_plates() -> None:
    case = COATED | {"electrode": "top", "collector": 2, "patch_size": 1e-3, "magnetic": "insulating"}
    contact = ContactCurves.from_case(case, 1.0, body=film(case, solver.find("PZT-4")))
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
    with pytest.raises(solver.FactorError, match=r"^base_volume_fraction: 0\.8 of a film whose electrode"):
        film({"collector": 1, "thickness": 1e-4, "base_volume_fraction": 0.8}, PVDF)


BESIDE = STUDY.replace(
    "signal: {design: touch, force: 50 mN, hold: 1 s}",
    """signal:
  case: {material: PZT-4, profile: sphere, radius: 5 mm, thickness: 0.1 mm, base: steel, surroundings: insulated}
  device: {amplifier: {input_capacitance: 10 pF, feedback_capacitance: 20 pF, charge_noise: 1 fC}}
  force: 50 mN
""",
)


def _moved_by_hand(case: dict[str, Any]) -> float:
    """Share of the charge per force by 5 % of every constant, 0.02 of steel's Poisson's ratio, each by itself."""
    step, film, steel = 0.01, solver.find("PZT-4"), solver.find("steel")
    families = (("c11", "c12", "c13", "c33", "c44"), ("e31", "e33", "e15"), ("eps11", "eps33"))
    scaled = [{name: getattr(film, name) * (1 + 0.05 * step) for name in names} for names in families]
    poisson = steel.c12 / (steel.c11 + steel.c12)
    young = 2 * steel.c44 * (1 + poisson)
    bases = [
        solver.Material.isotropic(young * (1 + 0.05 * step), poisson),
        solver.Material.isotropic(young, poisson + 0.02 * step),
    ]
    moved = [{"material": replace(film, **constants)} for constants in scaled]
    moved += [{"base": replace(steel, **{name: getattr(base, name) for name in families[0]})} for base in bases]
    start = float(solver.solve(case)["charge_per_force"])
    changes = [float(solver.solve(case | change)["charge_per_force"]) / start - 1 for change in moved]
    return float(np.linalg.norm(changes)) / step


def test_a_press_beside_the_designs_is_of_its_own_contact_and_amplifier(tmp_path: Path) -> None:
    study = made(BESIDE)
    assert isinstance(study.signal, Pressing)
    press_study = signal_case.of(study)
    shown = pressed.signal(press_study, study.signal, press_study.fixed).merge(pressed.held(press_study, study.signal))
    ball = COATED | {"radius": 5e-3, "base": "steel", "punch": "steel"}  # a device's default
    exact = solver.solve({**ball, "force": 0.05})
    charge = 0.05 * float(exact["charge_per_force"])
    assert float(shown["contact_charge"]) == pytest.approx(charge, rel=1e-9)
    write_whole(shown, tmp_path / "signal.nc")
    figures = tables.signal(tmp_path)
    assert figures["contact_output"] == pytest.approx(charge / 20e-12, rel=1e-5)  # open-loop gain 1e6
    warm = pressed.signal(press_study, study.signal, {**press_study.fixed, "touch_temperature": 300.0})
    assert float(warm["heat_at_end"]) != 0
    assert float(warm["contact_output"]) == float(shown["contact_output"])  # the card's output is the force's alone
    spread = pressed.spread(press_study, study.signal, press_study.fixed)
    moved = _moved_by_hand(ball | {"force": 0.05})
    assert float(spread["charge_spread"]) == pytest.approx(moved, rel=2e-3)  # forward quotients, their step a hundredth
    assert float(spread["output_spread"]) == pytest.approx(moved, rel=2e-3)  # Q/C_f
    figures |= {str(name): float(value) for name, value in spread.items()}
    assert figures["held"]["peak_pressure"] == pytest.approx(float(exact["peak_pressure"]), rel=1e-9)
    card = report.card(study, figures, figures["held"])
    assert card.title == "Steel ball, R = 5 mm, read by its amplifier"
    built = card.build.replace("\N{NO-BREAK SPACE}", " ")
    assert built == "PZT-4, 100 µm on steel; steel ball, R = 5 mm, insulated around"
    share = float(exact["peak_pressure"]) / solver.find("PZT-4").limits["depoling_stress"].value
    assert share > 1  # beyond what PZT-4 bears
    assert not card.good
    assert card.stops.startswith("Contact pressure of ")
    band = f"{100 * moved:.2g}\N{NO-BREAK SPACE}%"
    assert card.does.count(f"±\N{NO-BREAK SPACE}{band}") == 1
    bare = report.card(study, figures | {"charge_spread": np.nan, "output_spread": np.nan}, figures["held"])
    assert "±" not in bare.does
    half = report.card(study, figures, {name: value / (2 * share) for name, value in figures["held"].items()})
    assert half.good
    assert half.stops.startswith("The contact pressure is 50\N{NO-BREAK SPACE}% of the depoling stress of PZT-4, 83")
    assert half.verdict == "within linear theory"


def test_a_contact_with_tolerances_is_recommended_if_every_corner_keeps_the_limits_of_its_materials() -> None:
    banded = "  tolerance: {radius: 5 %, thickness: 4 um}\n  force: 50 mN"
    study = made(BESIDE.replace("radius: 5 mm,", "radius: 20 mm,").replace("  force: 50 mN", banded))
    assert isinstance(study.signal, Pressing)
    press_study = signal_case.of(study)
    values = pressed.held(press_study, study.signal)
    ball = press_study.fixed | {"force": study.signal.force}
    exact = [
        float(solver.solve({**ball, "radius": radius, "thickness": thickness})["peak_pressure"])
        for radius, thickness in ((0.02, 1e-4), (0.019, 9.6e-5), (0.019, 1.04e-4), (0.021, 9.6e-5), (0.021, 1.04e-4))
    ]
    np.testing.assert_allclose(values["held_peak_pressure"], exact, rtol=1e-9)
    numbers = {"force": study.signal.force, "contact_charge": 1e-12, "contact_output": 1.0, "noise_force": 1e-6}
    numbers |= {"time_constant": 1.0, "charge_spread": np.nan, "output_spread": np.nan}
    held = {str(name).removeprefix("held_"): array.values for name, array in values.items()}
    share = max(exact) / solver.find("PZT-4").limits["depoling_stress"].value
    bearing = {**held, "peak_pressure": held["peak_pressure"] * 0.9 / share}
    card = report.card(study, numbers, bearing)
    assert (card.verdict, card.good) == ("recommended", True)
    words = card.stops.replace("\N{NO-BREAK SPACE}", " ")
    assert words.startswith("Within the tolerances the contact pressure reaches 90 % of the depoling stress of PZT-4")
    assert card.build.replace("\N{NO-BREAK SPACE}", " ").endswith("(radius ± 5 % and thickness ± 4 µm)")
    broken = report.card(study, numbers, {**held, "peak_pressure": held["peak_pressure"] * 1.01 / share})
    assert (broken.verdict, broken.good) == ("beyond linear theory", False)
    heat = (LeftOut("heat", "signal", 1.0, 1.0, "K", 1.0, 3.1, "heat is 35 times the signal", "It is."),)
    bare = study.model_copy(update={"signal": study.signal.model_copy(update={"tolerance": {}})})
    for whole, room, kind in (
        (study, 0.9, "recommended within the model"),
        (study, 1.01, "beyond linear theory"),
        (bare, 0.9, "within linear theory"),
    ):
        card = report.card(whole, numbers, {**held, "peak_pressure": held["peak_pressure"] * room / share}, heat)
        assert (card.verdict, card.good) == (f"{kind}; heat is 35 times the signal", False)


@pytest.mark.parametrize(
    ("text", "old", "new", "words"),
    [
        (BESIDE, "radius: 5 mm,", "radus: 5 mm,", "signal.case.radus: 'radus' is not a factor; did you mean 'radius'"),
        (BESIDE, "radius: 5 mm,", "", "signal: case: radius: missing"),
        (BESIDE, "radius: 5 mm,", "radius: 5 mm, force: 0.1,", "signal: case: force: the press gives the force"),
        (BESIDE, "profile: sphere, radius: 5 mm, thickness: 0.1 mm, base: steel", "radius: 5 mm", "case: a film, or a"),
        (BESIDE, "profile: sphere, radius: 5 mm,", "radius: 5 mm,", "signal: device: electrode_length: missing"),
        (BESIDE, "signal:\n", "signal:\n  design: touch\n", "design: is given beside a case"),
        (STUDY, "design: touch", "design: tuch", "signal: design: 'tuch' is not a design target; known are touch"),
        (STUDY, "force: 50 mN", "force: 50 mV", "unit mismatch"),
        (STUDY, "hold: 1 s", "hold: 0", "0 is not a finite number > 0 [s]"),
        (STUDY, "device: {", "# {", "signal: needs device: amplifier"),
    ],
)
def test_a_press_that_cannot_be_is_refused(text: str, old: str, new: str, words: str) -> None:
    assert words in refusal(edited(text, old, new))


@pytest.mark.parametrize(
    ("factors", "words"),
    [({}, "patch_size: missing"), ({"patch_size": 1e-3, "patch": "strip"}, "patch: 'strip' below a point has no end")],
)
def test_electrodes_without_an_end_are_refused(factors: dict[str, Any], words: str) -> None:
    case = COATED | {"collector": 1}
    with pytest.raises(solver.FactorError, match=words):
        ContactCurves.from_case(case | factors, 1.0, body=film(case, solver.find("PZT-4")))
