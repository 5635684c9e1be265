"""A press in time on a study's design, and the patch that is read, against plates and dividers of charge."""

from pathlib import Path

import numpy as np
import pytest

import solver
from solver.names import OF_HEAT
from solver.stack.electrodes import Electrode
from solver.stack.layers import Layer, Stack
from storage.netcdf import write_whole
from tests.studies import edited, made
from workflow.device import pressed
from workflow.device.circuit import permittivity
from workflow.device.contact import ContactCurves, film
from workflow.language import numbers
from workflow.report import sentences, tables
from workflow.report.figures import signal_in_time
from workflow.study import load
from workflow.study.model import pressed as pressed_study
from workflow.study.reading import InputError
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
PHASES = ("BaTiO3", "CoFe2O4")
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
    assert f"{numbers.shown(charge / 10e-12, 'V', 3)} at the output" in said
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
    contact = ContactCurves.from_case(case, 1.0, body=film(case | {"force": 1.0}, {}, PHASES)[0])
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
        film(graded, {}, PHASES)


@pytest.mark.parametrize(
    ("named", "words"),
    [
        ("bal", r"mine\.yaml: signal: study: 'bal' is unknown: .*; did you mean 'ball'\?"),
        ("../ball", r"mine\.yaml: signal: '\.\./ball': a study's file must be named with"),
        ("other", r"mine\.yaml: signal: design: 'ball' is not a design target; known are touch"),
    ],
)
def test_a_design_of_another_study_that_cannot_be_is_refused(
    named: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MEECONTACT_STUDIES", "{}")
    monkeypatch.chdir(tmp_path)
    study = edited(STUDY, "signal: {design: touch", f"signal: {{study: {named}, design: ball")
    Path("mine.yaml").write_text(study, encoding="utf-8")
    Path("other.yaml").write_text(STUDY, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        pressed_study(load("mine.yaml"))
