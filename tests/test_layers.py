"""Every test has its layer, a layer's files exist, and a unit starts no program."""

import subprocess
import sys

import pytest

from tests import layers
from workflow.run.provenance import ROOT


def test_every_test_has_its_layer_and_every_listed_file_exists(request: pytest.FixtureRequest) -> None:
    for item in request.session.items:
        assert len({mark.name for mark in item.iter_markers()} & set(layers.LAYERS)) == 1, item.nodeid
    names = f"{layers.PROCESSES} {layers.DENSE} {layers.MOMENTS}".split()
    assert not [name for name in names if not (ROOT / "tests" / name).exists()]


def test_a_unit_starts_no_program() -> None:
    with layers.without_programs(), pytest.raises(AssertionError, match="of the layer 'unit' starts"):
        subprocess.run([sys.executable, "-V"], check=True)
