"""The format of surrogate.nc: the reader in JavaScript, written from the page alone, agrees with the program."""

import json
import os
import re
import subprocess
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

import surrogate
from storage.sealed import SEAL, seal
from surrogate.face.model import GaussianProcess
from tests import programs
from tests.surrogate import grouped
from tests.surrogate.functions import inside
from tests.workflow.conftest import Project
from workflow.run.provenance import ROOT

pytestmark = pytest.mark.needs("node", "ncdump")  # examples/surrogate.mjs reads files by ncdump
PAGE = (ROOT / "docs/format.md").read_text(encoding="utf-8")
READER = """
  const [path, points] = process.argv.slice(1), { read, predict } = await import(process.env.READER), file = read(path);
  console.log(JSON.stringify(JSON.parse(points).map((point) => predict(file, point))));
"""
PARTS = ("mean", "std", "lower", "upper")


def read_by_node(path: Path, points: list[dict[str, float]]) -> subprocess.CompletedProcess[str]:
    command = [programs.path("node"), "--input-type=module", "-e", READER, str(path), json.dumps(points)]
    environment = os.environ | {"READER": (ROOT / "examples/surrogate.mjs").as_uri()}
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


def root() -> GaussianProcess:
    """Model of the page's example."""
    x = surrogate.Input("x", 1.0, 4.0, "log")
    data = xr.Dataset({"y": ("x", np.sqrt(x.levels(3)))}, coords={"x": x.levels(3)})
    return surrogate.GridGP(inputs=[x], hyperparameters={"x": 0.1}).fit(data)


@pytest.fixture(scope="module")
def files(quickstart_run: Project, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A calibrated grid, one over groups, and the page's example."""
    folder = tmp_path_factory.mktemp("format")
    surrogate.save(grouped.calibrated(), folder / "grouped.nc")
    surrogate.save(root(), folder / "root.nc")
    grid = quickstart_run.folder / "results/quickstart/surrogate.nc"
    return {"grid": grid, "grouped": folder / "grouped.nc", "root": folder / "root.nc"}


@pytest.mark.parametrize("kind", ["grid", "grouped", "root"])
def test_the_reader_agrees_with_the_program(kind: str, files: dict[str, Path]) -> None:
    model = surrogate.load(files[kind])
    X = inside(model.inputs_, 12, 3, 1.0)
    X[0], X[1] = [axis.low for axis in model.inputs_], [axis.high for axis in model.inputs_]
    points = [dict(zip(model.box, row, strict=True)) for row in X.tolist()]
    mean, std = model.predict_array(X, return_std=True)
    expected = dict(zip(PARTS, (mean, std, *model.interval_array(X)), strict=True))
    answer = json.loads(read_by_node(files[kind], points).stdout)
    for p, name in enumerate(model.outputs_):
        for part in PARTS:
            values = np.array([point[name][part] for point in answer])
            size = 0.0 if part == "std" else float(np.abs(expected[part][..., p]).max())
            # of the variance some terms nearly vanish near a level
            rtol = 1e-10 if part == "std" else 0.0
            np.testing.assert_allclose(values, expected[part][..., p], rtol=rtol, atol=1e-12 * size, err_msg=name)


def test_the_example_by_hand_is_the_file_s(files: dict[str, Path]) -> None:
    rows = {
        head: [float(number) for number in row.split(", ")]
        for head, row in re.findall(r"^\| (.+?) \| ([-\d., ]+) \|$", PAGE, re.M)
    }
    with netCDF4.Dataset(files["root"]) as file:
        for head, shown in rows.items():
            if head[0] == "`":
                stored = np.concatenate([np.ravel(file[name.strip("`")][:]) for name in head.split(", ")])
                np.testing.assert_allclose(stored, shown, atol=6e-11)
    model = root()
    mean, std = model.predict_array(np.array([[3.0]]), return_std=True)
    assert rows["interval"] == pytest.approx(np.ravel(model.interval_array(np.array([[3.0]]))), abs=6e-11)
    assert next(row for head, row in rows.items() if head.startswith("mean")) == pytest.approx(mean[0], abs=6e-11)
    assert next(row for head, row in rows.items() if head.startswith("std")) == pytest.approx(std[0], abs=6e-11)


def test_the_reader_refuses_other_kernels_and_points_outside(tmp_path: Path, files: dict[str, Path]) -> None:
    levels = surrogate.chebyshev_levels(0.0, 1.0, 4)
    data = xr.Dataset({"y": ("x", levels**2)}, coords={"x": levels})
    cases = xr.Dataset({"x": ("case", data["x"].values), "y": ("case", data["y"].values)})
    surrogate.save(surrogate.ScatterGP(outputs=["y"]).fit(cases), tmp_path / "scattered.nc")
    assert 'engine "scatter" is not read here' in read_by_node(tmp_path / "scattered.nc", []).stderr
    assert "x is from 1 to 4" in read_by_node(files["root"], [{"x": 5.0}]).stderr


@pytest.mark.slow
def test_the_reader_refuses_a_broken_file_in_one_line(tmp_path: Path, files: dict[str, Path]) -> None:
    raw = files["root"].read_bytes()
    broken = {name: tmp_path / f"{name}.nc" for name in ("cut", "flipped", "changed", "missing")}
    broken["cut"].write_bytes(raw[:-100])
    broken["flipped"].write_bytes(raw[: len(raw) // 2] + bytes([raw[len(raw) // 2] ^ 1]) + raw[len(raw) // 2 + 1 :])
    broken["changed"].write_bytes(raw[: -SEAL.size])
    with netCDF4.Dataset(broken["changed"], "a") as file:
        file["output_scale"][:] *= 1 + 1e-6
    seal(broken["changed"])
    words = ("no seal", "altered", "do not come out again", "no such file")
    for path, message in zip(broken.values(), words, strict=True):
        command = [programs.path("node"), "--max-old-space-size=512", str(ROOT / "examples/surrogate.mjs")]
        done = subprocess.run([*command, str(path), "x=2"], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), path
        assert message in done.stderr
