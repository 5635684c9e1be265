"""``meecontact serve`` as a process that speaks UM-Bridge; its own client speaks to it in `make referees`."""

import json
import os
import re
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import surrogate
from solver import solve
from tests.patience import PATIENCE
from tests.workflow.conftest import Project

JSON = {"Content-Type": "application/json"}
AT = {"volume_fraction": 0.55, "friction": 0.2, "radius": 0.05, "load": 3e4}


@pytest.fixture(scope="module")
def trained(ran: Project) -> Path:
    return ran.folder / "results/small/surrogate.nc"


@pytest.fixture(scope="module")
def address(ran: Project, trained: Path) -> Iterator[str]:
    program = str(Path(sys.executable).with_name("meecontact"))
    command = [program, "serve", str(trained), "--exact", "small", "--port", "0"]
    environment = {**os.environ, "PYTHONPATH": str(ran.modules)}
    with subprocess.Popen(command, cwd=ran.folder, env=environment, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        line = process.stderr.readline()
        found = re.search(r"http://127\.0\.0\.1:\d+", line)
        assert found, line + process.stderr.read()
        yield found[0]
        process.terminate()


def asked(address: str, path: str, **body: object) -> Any:
    """The answer to a request of UM-Bridge's protocol, version 1.0."""
    request = urllib.request.Request(address + path, data=json.dumps(body).encode(), headers=JSON)
    with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
        return json.load(answer)


def test_the_surrogate_answers_with_its_derivatives(address: str, trained: Path) -> None:
    truth = surrogate.load(trained)
    with urllib.request.urlopen(address + "/Info", timeout=PATIENCE) as answer:
        assert json.load(answer) == {"protocolVersion": 1.0, "models": ["surrogate", "exact"]}
    assert asked(address, "/InputSizes", name="surrogate") == {"inputSizes": [len(truth.inputs_)]}
    assert asked(address, "/OutputSizes", name="surrogate") == {"outputSizes": [len(truth.outputs_)]}
    support = asked(address, "/ModelInfo", name="surrogate")["support"]
    assert support == {"Evaluate": True, "Gradient": True, "ApplyJacobian": True, "ApplyHessian": False}
    at = [AT[name] for name in truth.box]
    found = asked(address, "/Evaluate", name="surrogate", input=[at], config={})
    assert found == {"output": [truth.predict_array(np.array([at]))[0].tolist()]}
    slopes = truth.gradient_array(np.array([at]))[0]
    wanted = {"name": "surrogate", "input": [at], "inWrt": 0, "outWrt": 0, "config": {}}
    weights = np.linspace(1, 2, len(truth.outputs_))
    gradient = asked(address, "/Gradient", sens=weights.tolist(), **wanted)["output"]
    assert gradient == pytest.approx(weights @ slopes, rel=1e-12)
    applied = asked(address, "/ApplyJacobian", vec=[1, 0, 0, 0], **wanted)["output"]
    assert applied == pytest.approx(slopes[:, 0], rel=1e-12)


def test_the_exact_solution_answers(address: str, trained: Path) -> None:
    names = surrogate.load(trained).outputs_
    assert not asked(address, "/ModelInfo", name="exact")["support"]["Gradient"]
    (found,) = asked(address, "/Evaluate", name="exact", input=[list(AT.values())])["output"]
    exact = solve(AT)
    for name, value in zip(names, found, strict=True):
        assert value == pytest.approx(float(exact[name]), rel=1e-12), name


@pytest.mark.parametrize(
    ("path", "body", "told"),
    [
        ("/Evaluate", b'{"name": "surrogate", "input": [[9, 0.2, 0.05, 3e4]]}', "volume_fraction = 9 is outside"),
        ("/Evaluate", b'{"name": "surrogate", "input": [[0.5, NaN, 0.05, 3e4]]}', "input: must be 4 finite numbers"),
        ("/Evaluate", b'{"name": "surrogate", "input": [0.5]}', "input: must be 4 finite numbers"),
        ("/Evaluate", b'{"name": "other"}', "name: 'other' is unknown; allowed: surrogate, exact"),
        ("/Gradient", b'{"name": "exact"}', "the exact model has no derivatives"),
        ("/Evaluate", b"[" * 100_000, "the request must be a JSON object"),
        ("/Elsewhere", b"{}", "/Elsewhere: unknown; allowed: /Info"),
    ],
)  # fmt: skip
def test_a_wrong_request_costs_one_line(address: str, path: str, body: bytes, told: str) -> None:
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(urllib.request.Request(address + path, body, JSON), timeout=PATIENCE)
    assert refused.value.code == 400
    assert told in refused.value.read().decode()
    refused.value.close()
