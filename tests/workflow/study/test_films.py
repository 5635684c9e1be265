"""Studies of films: what they accept, what their cases have, and the one line with which they are refused."""

import pytest

from solver.names import FILM_QUANTITIES, QUANTITIES
from tests.studies import made, shipped
from workflow.study import coupling, datum
from workflow.study.model import Study

FILM = """\
title: A film
fixed: {surroundings: insulated, composite: fibrous, radius: 0.05, interface_electric: grounded}
categories: {base: [rigid, steel]}
factors:
  load: {low: 2e4, high: 4e4, levels: 3, scale: log}
  thickness: {low: 2e-4, high: 3e-4, levels: 3, scale: log}
  friction: {low: 0.0, high: 0.3, levels: 3}
  volume_fraction: {low: 0.4, high: 0.6, levels: 3}
design:
  thin:
    maximise: abs(voltage_per_load)
    over: [thickness, base]
    at: {load: 3e4, friction: 0.0, volume_fraction: 0.5}
    subject_to: [nominal_field <= 3 kV/mm]
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return made(FILM)


def test_cases_have_the_quantities_of_films(study: Study) -> None:
    assert study.quantities == [*QUANTITIES, *FILM_QUANTITIES]
    # a nominal field bends where the voltage changes sign: designs take it from voltage and thickness
    assert set(study.quantities) - set(study.outputs) == {"nominal_field"}
    assert study.design["thin"].names() == ["voltage_per_load", "voltage", "thickness"]
    searched = study.model_copy(update={"dataset": study.dataset.model_copy(update={"peaks": True})})
    # no file holds a position where nothing is tensile, and a rigid base has no stresses
    assert set(searched.quantities) - set(study.quantities) == {
        "interface_shear", "interface_shear_position", "interface_tension", "film_peak_von_mises",
        "film_peak_principal_tension",
    }  # fmt: skip


def test_only_depths_on_a_base_that_gives_hang_on_the_datum(study: Study) -> None:
    rigid, steel = (study.narrowed({"base": base}) for base in ("rigid", "steel"))
    assert datum.hanging(rigid) == frozenset()
    # the interface to steel is bonded in the magnetic field: what a charge adds is relative, the load's part is not
    hangs = {"depth", "flux_per_force", "blocked_load_per_volt", "blocked_load_per_ampere"}
    assert datum.hanging(steel) == hangs == datum.hanging(study)
    charged = steel.model_copy(update={"fixed": {**steel.fixed, "magnetic_charge": 1e-4}})
    assert datum.hanging(charged) == {*hangs, "magnetic_potential"}
    assert datum.meaning("voltage", datum.hanging(study)) == "electric potential of the punch"
    assert datum.meaning("depth", datum.hanging(study)) == "indentation depth relative to the datum"


QUICKSTART = shipped("quickstart")


def made_of(**fixed: str | float) -> Study:
    """The quickstart of something else, without its designs."""
    factors = {name: axis for name, axis in QUICKSTART.factors.items() if name not in ("volume_fraction", "charge")}
    return QUICKSTART.model_copy(update={"fixed": fixed, "factors": factors, "design": {}})


def test_a_field_needs_a_material_that_couples_to_it_or_a_charge() -> None:
    assert coupling.fields(QUICKSTART) == {"electric", "magnetic"}
    assert coupling.fields(made_of(material="PZT-4")) == {"electric"}
    assert coupling.fields(made_of(material="CoFe2O4")) == {"magnetic"}
    assert coupling.fields(made_of(composite="AlScN", scandium_fraction=0.3)) == {"electric"}
    assert coupling.fields(made_of(material="glass")) == set()
    assert coupling.fields(made_of(material="glass", charge=1e-6)) == {"electric"}
    assert coupling.fields(shipped("paper")) == {"electric", "magnetic"}


def test_quantities_of_a_field_that_is_none_are_not_told_unless_they_are_asked_for() -> None:
    study = made_of(material="PZT-4")
    names = coupling.told(study)
    assert {"voltage", "peak_pressure", "stroke_per_volt"} <= set(names)
    assert not {"magnetic_potential", "flux_per_force", "stroke_per_ampere", "permeance_per_length"} & set(names)
    surrogate = study.surrogate.model_copy(update={"outputs": ["depth", "magnetic_potential"]})
    assert coupling.told(study.model_copy(update={"surrogate": surrogate})) == ["depth", "magnetic_potential"]
    assert coupling.told(QUICKSTART) == QUICKSTART.outputs
