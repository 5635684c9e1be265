"""Fields that no material couples to are not shown, nor the quantities that measure them."""

from tests.studies import shipped
from workflow.study import coupling
from workflow.study.model import Study

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
