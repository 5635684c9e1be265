"""The punch of a device whose study names none."""

import pytest

from tests.workflow.study.test_surroundings import BOX, settled
from workflow.study import defaults


def test_a_device_is_pressed_by_steel_unless_it_says_otherwise() -> None:
    study = settled()
    defaults.press(study)
    assert study.fixed["punch"] == "steel"
    assert study.elastic
    assert study.defaults[-1].startswith("punch: steel, the default of a study with a device")


@pytest.mark.parametrize(
    "fixed", [{"punch": "rigid"}, {"punch": "brass"}, {"punch_modulus": 7e10, "punch_poisson": 0.3}]
)
def test_what_a_study_says_stays(fixed: dict[str, object]) -> None:
    study = settled(fixed=fixed)
    defaults.press(study)
    assert {name: study.fixed[name] for name in fixed} == fixed
    assert not any(line.startswith("punch") for line in study.defaults)
    bare = settled(device=None)
    defaults.press(bare)
    assert "punch" not in bare.fixed


def test_groups_that_have_no_place_for_it_leave_it_rigid() -> None:
    groups = {"load * radius / thickness^2": {"levels": 3}}
    study = settled(factors=BOX, groups=groups, surrogate={"outputs": ["depth", "voltage"]})
    defaults.press(study)
    assert "punch" not in study.fixed
    assert (
        study.defaults[-1]
        == "punch: rigid, since its groups do not tell what one of steel makes of its surrogate.outputs"
    )
