"""Cost of what users call most, beside numpy, scipy and scikit-learn in the same run, and over what issue 42 asked.

Processor time on one thread. A contact in air solves systems of its 160 unknowns (320 with friction): the yardstick is
`numpy.linalg.solve` of one. That of commands and studies is `import numpy`.
"""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

import solver
from approximation.arrays import Array
from approximation.chebyshev import gauss_points
from benchmarks import least, scattered, timed
from benchmarks.rivals import GRID_RIVALS, installed
from surrogate import GridGP, Input
from workflow.run.provenance import ROOT

#: Cases of the tables, distinct materials of a table of few, queries, and loads or forces of the contacts in air.
ROWS, MATERIALS, QUERIES, LOADS = 100_000, 20, 20_000, 24
_FILM: dict[str, float | str] = {
    "material": "PZT-4", "punch": "steel", "surroundings": "air", "magnetic": "insulating", "base": "steel",
    "interface_electric": "grounded",
}  # fmt: skip
#: Ends of the factors of scattered cases.
BOX = {"radius": (0.02, 0.1), "load": (1e4, 1e5), "friction": (0.0, 0.4)}
_LINE = _FILM | {"thickness": 3e-4, "radius": 0.05}
_BALL = _FILM | {"profile": "sphere", "thickness": 5e-5, "radius": 1e-2}
#: Films in air: the case, the factor that varies with its range, and the number of unknowns.
AIR: dict[str, tuple[dict[str, float | str], str, tuple[float, float], int]] = {
    "line in air, a further load": (_LINE, "load", (5e3, 9e3), 160),
    "line in air with friction, a further load": (_LINE | {"friction": 0.2}, "load", (5e3, 9e3), 320),
    "ball in air, a further force": (_BALL, "force", (0.02, 0.2), 160),
    "ball in air with friction, a further force": (_BALL | {"friction": 0.2}, "force", (0.02, 0.2), 320),
}
COMMANDS = {
    "meecontact --help": ["--help"],
    "meecontact solve, one row": ["solve", "--at", "material=PZT-4,radius=5 cm,load=10 kN/m"],
}
_QUERY = "volume_fraction=0.5,friction=0.2,radius=0.05,load=1e4,charge=0"
#: Studies that are run, and measured rows that the surrogate of the first learns from.
STUDIES, MEASURED = ("quickstart", "large"), 40
#: Most seconds of processor time that issue 42 asks for.
SECONDS = {
    "line in air, a further load": 20e-3, "line in air with friction, a further load": 30e-3,
    "ball in air, a further force": 5e-3, "half-planes, a material a row, a row": 10e-6,
    "half-plane, a case alone": 3e-3, "meecontact --help": 0.3, "meecontact solve, one row": 0.8,
    "meecontact query": 0.8, "meecontact learn": 3.0, "study quickstart": 35.0, "study large": 60.0,
}  # fmt: skip
#: Scattered cases of the comparison of fits.
SCATTERED = 256


def measure() -> dict[str, float]:
    """Seconds of processor time, ratios to the yardsticks, and ratios to what was asked."""
    return {**in_air(), **tables(), **commands(), **studies(), **queries(), **fits()}


def in_air() -> dict[str, float]:
    """Cost of one more case of a film in air, its table made."""
    result = dict[str, float]()
    for name, (case, factor, ends, unknowns) in AIR.items():
        loads = np.linspace(*ends, LOADS)
        one_load, all_loads = (
            _solving(case | {factor: xr.DataArray(part, dims="case")}) for part in (loads[:1], loads)
        )
        all_loads()
        cost = (least(all_loads).processor - least(one_load).processor) / (LOADS - 1)
        result |= _beside(name, cost, "numpy.linalg.solve", _linear(unknowns))
    return result


def tables() -> dict[str, float]:
    """Cost of one row of scattered cases on half-planes of one, few and many materials; of a case alone."""
    random = np.random.default_rng(1)
    cases = {name: random.uniform(*ends, ROWS) for name, ends in BOX.items()}
    few = np.linspace(0.1, 0.9, MATERIALS)
    fractions = {
        "half-planes, one material, a row": few[:1],
        f"half-planes, {MATERIALS} materials, a row": random.choice(few, ROWS),
        "half-planes, a material a row, a row": random.uniform(0.1, 0.9, ROWS),
    }
    result = dict[str, float]()
    for name, fraction in fractions.items():
        result |= _beside(name, least(_half_planes(fraction, cases)).processor / ROWS)
    alone = _half_planes(few[:1], {name: values[:1] for name, values in cases.items()})
    alone()
    return result | _beside("half-plane, a case alone", least(alone, 20).processor)


def _half_planes(fraction: Array, cases: Mapping[str, Array]) -> Callable[[], xr.Dataset]:
    """A table of sliding cylinders on a composite."""
    columns = {name: xr.DataArray(values, dims="case") for name, values in cases.items()}
    fractions = xr.DataArray(fraction, dims="case") if fraction.size > 1 else float(fraction[0])
    return _solving(columns | {"composite": "fibrous", "volume_fraction": fractions})


def commands() -> dict[str, float]:
    """Cost of commands as whole processes."""
    numpy_alone = least(_process("import numpy")).processor
    result = dict[str, float]()
    for name, words in COMMANDS.items():
        result |= _beside(name, least(_meecontact(*words)).processor, "import numpy", numpy_alone)
    return result


def studies() -> dict[str, float]:
    """Cost of whole studies, and of a query of the first and of learning from measured rows."""
    numpy_alone = least(_process("import numpy")).processor
    result = dict[str, float]()
    with tempfile.TemporaryDirectory() as folder:
        run = partial(_meecontact, folder=folder)
        shutil.copytree(ROOT / "config", Path(folder) / "config")
        for name in STUDIES:
            cost = timed(run("run", name, "--cores", "1"))[1].processor
            result |= _beside(f"study {name}", cost, "import numpy", numpy_alone)
        surrogate, measured = f"results/{STUDIES[0]}/surrogate.nc", Path(folder) / "measured.csv"
        _measured().to_dataframe().to_csv(measured, index=False)
        actions = {"query": ["query", surrogate, "--at", _QUERY], "learn": ["learn", str(measured), "--on", surrogate]}
        for name, words in actions.items():
            result |= _beside(f"meecontact {name}", least(run(*words)).processor, "import numpy", numpy_alone)
    return result


def _measured() -> xr.Dataset:
    """Rows within the box of the quickstart, with voltage and depth as if measured."""
    random = np.random.default_rng(3)
    ends = BOX | {"volume_fraction": (0.1, 0.9), "charge": (-1e-6, 1e-6)}
    factors = {name: xr.DataArray(random.uniform(*end, MEASURED), dims="case") for name, end in ends.items()}
    return solver.solve(factors)[["voltage", "depth"]].reset_coords(drop=True).assign(factors)


def fits() -> dict[str, float]:
    """Cost and error of a fit to scattered cases, beside the other packages that are installed."""
    rows = {method.name: scattered.row(method, "circuit", SCATTERED) for method in installed(scattered.METHODS)[0]}
    cost, error = "fit, seconds of processor time", "root-mean-square error over range"
    ours, result = rows.pop(scattered.METHODS[0].name), dict[str, float]()
    for name, row in rows.items():
        result |= _beside(f"fit of {SCATTERED} scattered cases", ours[cost], name, row[cost])
        result[f"its error, over {name}"] = ours[error] / row[error]
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
    X = random.uniform(-1, 1, (QUERIES, 4))
    ours, scipy = (
        least(action).processor / QUERIES for action in (lambda: model.predict_array(X), lambda: spline(X, False))
    )
    return _beside("a query of a mean", ours, "scipy NdBSpline", scipy)


def _beside(name: str, cost: float, rival: str = "", yardstick: float = np.nan) -> dict[str, float]:
    """Cost [s] of a row, over that of its yardstick, if there is one, and over what was asked."""
    row = {f"{name} [s]": cost} | ({f"{name}, over {rival}": cost / yardstick} if rival else {})
    return row | ({f"{name}, over what was asked": cost / SECONDS[name]} if name in SECONDS else {})


def _solving(case: Mapping[str, object]) -> Callable[[], xr.Dataset]:
    return lambda: solver.solve(case)


def _linear(unknowns: int) -> float:
    matrix, right = np.random.default_rng(0).normal(size=(unknowns, unknowns)), np.ones(unknowns)
    return least(lambda: [np.linalg.solve(matrix, right) for _ in range(50)]).processor / 50


def _meecontact(*words: str, folder: str | None = None) -> Callable[[], object]:
    return _process("import sys; from workflow.cli.main import main; sys.exit(main())", *words, folder=folder)


def _process(code: str, *words: str, folder: str | None = None) -> Callable[[], object]:
    def run() -> None:
        done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, cwd=folder)
        if done.returncode:
            raise RuntimeError(f"{' '.join(words)}: {done.stderr[-2000:]}")

    return run
