"""``meecontact serve``: a surrogate and the exact solver behind the HTTP protocol of UM-Bridge.

Any code for uncertainty quantification that speaks UM-Bridge (version 1.0) can drive them: L. Seelinger et al., Journal
of Open Source Software 8 (2023) 4748. Two models of the same input and output: `surrogate`, with derivatives,
and, where a study is given, `exact`.

The protocol's own package (umbridge 1.2) has a server too, on aiohttp. It is not used: it listens on every address of
the machine without a choice, accepts requests of any size, media type, Host and Origin, and writes NaN into its JSON.
`make referees` lets the package's client speak to `workflow.cli.localhttp`.
"""

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

import surrogate
from solver import FactorError, MaterialError
from surrogate import GaussianProcess, OutOfBoxError
from workflow.cli import localhttp
from workflow.cli.query import study_of
from workflow.cli.words import say, surrogate_file, trained
from workflow.dataset import factorial
from workflow.study.model import Study
from workflow.study.reading import InputError, one_line

PORT = 4242  # the protocol's usual one
_VERSION = 1.0

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Model:
    """One input vector, the factors in the surrogate's order, to one output vector, the quantities in its order."""

    surrogate: GaussianProcess  # The trained one, which says the box
    study: Study | None = None  # Where it came from: then the model is the exact solver

    @property
    def sizes(self) -> tuple[int, int]:
        """Of the input and the output."""
        return len(self.surrogate.inputs_), len(self.surrogate.outputs_)

    @property
    def differentiable(self) -> bool:
        """Whether it has derivatives."""
        return self.study is None

    def evaluate(self, at: Vector) -> Vector:
        """(n_inputs,) -> (n_outputs,), in SI units."""
        mean = self.surrogate.predict_array(at[None])[0]  # refuses what is outside the box, for both
        if self.study is None:
            return np.asarray(mean, dtype=np.float64)
        points = {name: xr.DataArray([value], dims="point") for name, value in zip(self.surrogate.box, at, strict=True)}
        exact = factorial.training_data(self.study, factorial.exact(self.study, points))
        return np.array([float(exact[name].values[0]) for name in self.surrogate.outputs_])

    def jacobian(self, at: Vector) -> Vector:
        """(n_inputs,) -> (n_outputs, n_inputs)."""
        return np.asarray(self.surrogate.gradient_array(at[None])[0], dtype=np.float64)


class _RefusedError(Exception):
    """What the protocol calls an error: its type, and a line."""

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


def answer(models: Mapping[str, Model], path: str, body: Mapping[str, Any]) -> dict[str, Any]:
    """What the protocol answers to a request."""
    try:
        if path == "/Info":
            return {"protocolVersion": _VERSION, "models": list(models)}
        if path not in _REQUESTS:
            raise _RefusedError("UnsupportedFeature", f"{path[:60]}: unknown; allowed: /Info, {', '.join(_REQUESTS)}")
        name = body.get("name")
        if not isinstance(name, str) or name not in models:
            raise _RefusedError("ModelNotFound", f"name: {str(name)[:60]!r} is unknown; allowed: {', '.join(models)}")
        return _REQUESTS[path](models[name], body)
    except _RefusedError as error:
        kind, message = error.kind, str(error)
    except (OutOfBoxError, FactorError, MaterialError, ValueError) as error:
        kind, message = "InvalidInput", one_line(str(error))
    return {"error": {"type": kind, "message": message}}


def _supported(model: Model, _: Mapping[str, Any]) -> dict[str, Any]:
    has = model.differentiable
    return {"support": {"Evaluate": True, "Gradient": has, "ApplyJacobian": has, "ApplyHessian": False}}


def _evaluated(model: Model, body: Mapping[str, Any]) -> dict[str, Any]:
    return {"output": [_finite(model.evaluate(_input(model, body)))]}


def _gradient(model: Model, body: Mapping[str, Any]) -> dict[str, Any]:
    derivatives = _derivatives(model, body)
    return {"output": _product(derivatives.T, _vector(body, "sens", model.sizes[1]))}


def _jacobian_applied(model: Model, body: Mapping[str, Any]) -> dict[str, Any]:
    derivatives = _derivatives(model, body)
    return {"output": _product(derivatives, _vector(body, "vec", model.sizes[0]))}


def _product(matrix: Vector, vector: Vector) -> list[float]:
    with np.errstate(over="ignore", invalid="ignore"):
        return _finite(matrix @ vector)


def _finite(values: Vector) -> list[float]:
    """Numbers that JSON can write: it has no NaN and no infinity."""
    if not np.isfinite(values).all():
        raise _RefusedError("InvalidInput", "the answer is beyond the largest number")
    return [float(value) for value in values]


_REQUESTS: dict[str, Callable[[Model, Mapping[str, Any]], dict[str, Any]]] = {
    "/ModelInfo": _supported,
    "/InputSizes": lambda model, _: {"inputSizes": [model.sizes[0]]},
    "/OutputSizes": lambda model, _: {"outputSizes": [model.sizes[1]]},
    "/Evaluate": _evaluated,
    "/Gradient": _gradient,
    "/ApplyJacobian": _jacobian_applied,
}


def _input(model: Model, body: Mapping[str, Any]) -> Vector:
    vectors = body.get("input")
    if not isinstance(vectors, list) or len(vectors) != 1:
        raise _RefusedError("InvalidInput", "input: must be a list of one vector")
    return _vector({"input": vectors[0]}, "input", model.sizes[0])


def _vector(body: Mapping[str, Any], key: str, size: int) -> Vector:
    given = body.get(key)
    if isinstance(given, list) and len(given) == size and all(isinstance(number, float) for number in given):
        vector = np.array(given, dtype=np.float64)
        if np.isfinite(vector).all():
            return vector
    raise _RefusedError("InvalidInput", f"{key}: must be {size} finite numbers")


def _derivatives(model: Model, body: Mapping[str, Any]) -> Vector:
    if not model.differentiable:
        raise _RefusedError("UnsupportedFeature", "the exact model has no derivatives")
    if body.get("inWrt", 0) != 0 or body.get("outWrt", 0) != 0:
        raise _RefusedError("InvalidInput", "inWrt, outWrt: there is one input and one output, number 0")
    return model.jacobian(_input(model, body))


def serve(options: argparse.Namespace) -> None:
    """Answer requests until interrupted."""
    if not 0 <= options.port < 2**16:
        raise InputError(f"--port: {options.port} must be within 0 and 65535")
    model = surrogate.load(trained(options.surrogate))
    models = {"surrogate": Model(model)}
    if options.exact is not None:
        models["exact"] = Model(model, study_of(model, options.exact))
    with localhttp.server(partial(answer, models), options.host, options.port) as bound:
        host, port = bound.server_address[:2]
        say(f"serving {' and '.join(models)} at http://{host!s}:{port} (UM-Bridge); stop it by Ctrl-C")
        say(f"input: {', '.join(model.box)}; output: {', '.join(model.outputs_)}")
        try:
            bound.serve_forever()
        except KeyboardInterrupt:
            say("stopped")


def add(commands: Any) -> None:
    """Register the command."""
    command = commands.add_parser(
        "serve",
        help="a surrogate, and the exact solver, over HTTP for any UM-Bridge client",
        description="Answers UM-Bridge requests: input 0 is the vector of factors, output 0 that of quantities, both "
        "in SI units and in the order that is printed at the start.",
    )
    command.add_argument("surrogate", type=surrogate_file, metavar="surrogate.nc", help="or results/STUDY")
    command.add_argument("--exact", metavar="STUDY", help="also the exact solver: the study that it came from")
    command.add_argument("--port", type=int, default=PORT, help=f"default: {PORT}; 0: any that is free")
    command.add_argument("--host", default="127.0.0.1", help="default: this machine only; there is no password")
    command.set_defaults(run=serve)
