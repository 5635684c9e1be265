"""A file that a job reads is the one that its path and the state of the study say, or the job ends in one line."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from storage import netcdf
from storage.blocks import write_blocks
from storage.sealed import FormatError
from tests.workflow.conftest import job
from workflow.run import joblog, lock

STATE, OTHER = "fixed factors: 0123", "fixed factors: 4567"
DATA = xr.Dataset({"x": ("case", np.arange(3.0))})


@pytest.fixture(autouse=True)
def _run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A run of the study ``own`` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    lock.claim({"own": {}}, "mee/results", None, {"own": [STATE]})
    yield
    lock.release()
    netcdf.bind({}, {})


def begin(study: str, output: str, *inputs: str, state: str = STATE) -> None:
    """Begin a job that makes one file out of others."""
    joblog.bind(job(study, output, *inputs, parameter=state))


def slab(study: str, number: int, state: str = STATE) -> str:
    """A slab as a job writes it."""
    path = Path(f"mee/results/{study}/fields/slab_{number}.nc")
    path.parent.mkdir(parents=True, exist_ok=True)
    begin(study, str(path), state=state)
    if number:
        netcdf.write_whole(DATA, path)
    else:
        write_blocks(path, DATA, [((slice(None),), {"x": DATA["x"].values})], {})
    return str(path)


def test_a_file_answers_what_its_path_and_study_say() -> None:
    first, second, foreign = slab("own", 0), slab("own", 1), slab("other", 0)
    begin("own", "mee/results/own/quantities.nc", first, second)
    for path in (first, second):
        assert netcdf.read_whole(path).attrs.keys().isdisjoint([netcdf.ANSWERS])
        with netcdf.read_whole(path, lazy=True) as lazy, netcdf.read_whole(path, names=["x"]) as part:
            np.testing.assert_array_equal(lazy["x"], part["x"])
    shutil.copy(first, "first.nc")
    for source, message in (
        (second, "holds own/fields/slab_1.nc, not own/fields/slab_0.nc; remove it, and run again"),
        (foreign, "holds other/fields/slab_0.nc, not own/fields/slab_0.nc"),
    ):
        shutil.copy(source, first)
        options: dict[str, Any]
        for options in ({}, {"lazy": True}, {"names": ["x"]}):
            with pytest.raises(FormatError, match=message):
                netcdf.read_whole(first, **options)


def test_a_file_of_another_state_of_the_study_is_refused() -> None:
    path = slab("own", 0, OTHER)
    begin("own", "mee/results/own/quantities.nc", path)
    with pytest.raises(FormatError, match=r"made from another state of the study \(fixed factors\); remove it"):
        netcdf.read_whole(path)
    netcdf.bind({}, {})
    netcdf.write_whole(DATA, path)  # by nobody's job
    begin("own", "mee/results/own/quantities.nc", path)
    with pytest.raises(FormatError, match="holds no name of a file"):
        netcdf.read_whole(path)
    lock.release()  # a script that runs alone knows the path only
    begin("own", path, state=OTHER)
    netcdf.write_whole(DATA, path)
    begin("own", "mee/results/own/quantities.nc", path)
    assert netcdf.read_whole(path).sizes == {"case": 3}
