"""Configuration that the pipeline does not read ends a run in one line, by whichever of Snakemake's ways it came."""

from typing import Any

import pytest

from tests.workflow.conftest import Copy
from workflow.study import configuration
from workflow.study.reading import InputError


@pytest.mark.parametrize(
    ("config", "entries", "reason"),
    [
        ({"stduy": "peaks"}, (), "'stduy': not read; did you mean 'study'"),
        ({"study": "peaks", "friction": 0.4}, (), "'friction': not read; the pipeline reads"),
        ({"study": None}, (), "None is no study"),
        ({"study": {"friction": "0.4"}}, (), "is no study"),
        ({"study": "film"}, ("study=peaks", "study=film"), "study=peaks study=film: study is given 2 times"),
    ],
)
def test_unread_configuration_is_refused(config: dict[str, Any], entries: tuple[str, ...], reason: str) -> None:
    with pytest.raises(InputError, match=reason) as refusal:
        configuration.study(config, entries)
    assert "\n" not in str(refusal.value)


def test_a_run_with_unread_configuration_plans_nothing(copy: Copy) -> None:
    project = copy("configuration")
    done = project.snakemake("-n", "--config", "study=small", "friction=0.4", check=False)
    assert done.returncode == 1
    assert "'friction': not read" in done.stdout + done.stderr
