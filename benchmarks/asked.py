"""Cost of what users call most, beside what numpy or scikit-learn takes for a part of it in the same run.

Processor time on one thread. A contact in air solves some systems of its 160 unknowns (320 with friction): the
yardstick is `numpy.linalg.solve` of one. A material costs one eigenproblem: that of tables is `numpy.linalg.eig` of an
8 x 8 matrix, a case at a time. A command starts Python and its libraries: that of commands is `import numpy`.
"""

import subprocess
import sys
from collections.abc import Callable, Mapping
from importlib.util import find_spec

import numpy as np
import xarray as xr

import solver
from approximation.arrays import Array
from approximation.chebyshev import gauss_points
from benchmarks import least, scattered
from benchmarks.rivals import GRID_RIVALS
from surrogate import GridGP, Input

#: Cases of the tables, and loads or forces of the contacts in air.
ROWS, LOADS = 20_000, 24
_FILM: dict[str, float | str] = {
    "material": "PZT-4", "punch": "steel", "surroundings": "air", "magnetic": "insulating", "base": "steel",
    "interface_electric": "grounded",
}  # fmt: skip
_LINE = _FILM | {"thickness": 3e-4, "radius": 0.05}
_BALL = _FILM | {"profile": "sphere", "thickness": 5e-5, "radius": 1e-2}
#: Films in air: the case, the factor that varies with its range, and the number of unknowns.
AIR: dict[str, tuple[dict[str, float | str], str, tuple[float, float], int]] = {
    "line in air, a further load": (_LINE, "load", (5e3, 9e3), 160),
    "line in air with friction, a further load": (_LINE | {"friction": 0.2}, "load", (5e3, 9e3), 320),
    "ball in air, a further force": (_BALL, "force", (0.02, 0.2), 160),
}
COMMANDS = {
    "meecontact --help": ["--help"],
    "meecontact solve, one row": ["solve", "--at", "material=PZT-4,radius=5 cm,load=10 kN/m"],
}
#: Scattered cases of the comparison of fits.
SCATTERED = 256


def measure() -> dict[str, float]:
    """Seconds of processor time, and ratios to the yardsticks."""
    return {**in_air(), **tables(), **commands(), **queries(), **fits()}


def in_air() -> dict[str, float]:
    """Cost of one more case of a film in air, its table made."""
    result = dict[str, float]()
    for name, (case, factor, ends, unknowns) in AIR.items():
        loads = np.linspace(*ends, LOADS)
        some, many = (_solving(case | {factor: xr.DataArray(part, dims="case")}) for part in (loads[:1], loads))
        many()
        cost = (least(many).processor - least(some).processor) / (LOADS - 1)
        result |= _beside(name, cost, "numpy.linalg.solve", _linear(unknowns))
    return result


def tables() -> dict[str, float]:
    """Cost of one row of scattered cases on half-planes of one material, and of a material a row; of a case alone."""
    random, result = np.random.default_rng(1), dict[str, float]()
    drawn = {"radius": (0.02, 0.1), "load": (1e3, 1e5), "friction": (0.0, 0.4)}
    case: dict[str, Array | float | str] = {"composite": "fibrous", "volume_fraction": 0.5}
    case |= {name: random.uniform(*ends, ROWS) for name, ends in drawn.items()}
    matrices = random.normal(size=(ROWS // 10, 8, 8))
    eig = least(lambda: [np.linalg.eig(matrix) for matrix in matrices]).processor / len(matrices)
    for name, fraction in (("one material", 0.5), ("a material a row", random.uniform(0.1, 0.9, ROWS))):
        factors = {
            key: xr.DataArray(value, dims="case") if isinstance(value, np.ndarray) else value
            for key, value in (case | {"volume_fraction": fraction}).items()
        }
        cost = least(_solving(factors)).processor / ROWS
        result |= _beside(f"half-planes, {name}, a row", cost, "numpy.linalg.eig", eig)
    alone = _solving({"composite": "fibrous", "volume_fraction": 0.5, "radius": 0.05, "load": 1e4, "friction": 0.2})
    alone()
    return result | _beside("half-plane, a case alone", least(alone, 20).processor, "numpy.linalg.eig", eig)


def commands() -> dict[str, float]:
    """Cost of commands as whole processes."""
    numpy_alone = least(_process("import numpy")).processor
    result = dict[str, float]()
    for name, words in COMMANDS.items():
        cost = least(_process("from workflow.cli.main import main; main()", *words)).processor
        result |= _beside(name, cost, "import numpy", numpy_alone)
    return result


def fits() -> dict[str, float]:
    """Cost and error of a fit to scattered cases, beside the other packages that are installed."""
    rows = {method.name: scattered.row(method, "circuit", SCATTERED) for method in scattered.METHODS
            if find_spec(method.package)}  # fmt: skip
    cost, error = "fit, seconds of processor time", "root-mean-square error over range"
    own, result = rows.pop(scattered.METHODS[0].name), dict[str, float]()
    for name, row in rows.items():
        result |= _beside(f"fit of {SCATTERED} scattered cases", own[cost], name, row[cost])
        result[f"its error, over {name}"] = own[error] / row[error]
    return result


def queries() -> dict[str, float]:
    """Cost of a query of one mean, in blocks, beside scipy's cubic spline through the same factorial."""
    random = np.random.default_rng(2)
    levels = [gauss_points(12)] * 4
    values = np.exp(sum((k + 1) / 4 * part for k, part in enumerate(np.meshgrid(*levels, indexing="ij"))))
    names = [f"x{k}" for k in range(4)]
    data = xr.DataArray(values, dict(zip(names, levels, strict=True)), names).to_dataset(name="y")
    model = GridGP(inputs=[Input(name, -1, 1) for name in names]).fit(data)
    spline = GRID_RIVALS["cubic grid spline (scipy NdBSpline)"](levels, values[..., None])
    X = random.uniform(-1, 1, (ROWS, 4))
    own, other = (
        least(action).processor / ROWS for action in (lambda: model.predict_array(X), lambda: spline(X, False))
    )
    return _beside("a query of a mean", own, "scipy NdBSpline", other)


def _beside(name: str, cost: float, other: str, yardstick: float) -> dict[str, float]:
    return {f"{name} [s]": cost, f"{name}, over {other}": cost / yardstick}


def _solving(case: Mapping[str, object]) -> Callable[[], object]:
    return lambda: solver.solve(case)


def _linear(unknowns: int) -> float:
    matrix, right = np.random.default_rng(0).normal(size=(unknowns, unknowns)), np.ones(unknowns)
    return least(lambda: [np.linalg.solve(matrix, right) for _ in range(50)]).processor / 50


def _process(code: str, *words: str) -> Callable[[], object]:
    return lambda: subprocess.run([sys.executable, "-c", code, *words], check=True, capture_output=True)
