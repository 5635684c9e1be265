"""Speed of the data set: solving and writing it against writing the same bytes alone, in one run.

``python -m benchmarks.dataset [LEVELS]`` takes so many levels of the first axis of `config/large.yaml` (40,000 cases
each) through what the rule `slab` does: solve, convert, sum up statistics and checksums, compress, seal, flush.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np

from benchmarks.history import printed
from benchmarks.timing import timed
from storage.netcdf import PACKED, read_whole
from workflow.dataset import factorial
from workflow.dataset import slabs as dataset
from workflow.run.provenance import ROOT
from workflow.study.model import Study, load


def measure(levels: int = 25, repeats: int = 3) -> dict[str, float]:
    """Seconds of each way, their ratios, and cases a second.

    ``step`` is what a run waits for: as many processes as cores, each with its slab, their start included. ``slab`` is
    one core's work on all of it, ``raw`` one core's writing of the same bytes. Processor time tells what the ways cost
    where the machine has other work too.
    """
    study, cores = _part(levels), len(os.sched_getaffinity(0))
    with tempfile.TemporaryDirectory(dir=ROOT) as folder:
        ours, raw = Path(folder) / "ours.nc", Path(folder) / "raw.nc"
        dataset.write_slab(study, 0, ours)
        unpacked = _contents(ours)
        ways: dict[str, Callable[[], object]] = {
            "step": lambda: _step(levels, cores, Path(folder)),
            "slab": lambda: dataset.write_slab(study, 0, ours),
            "raw": lambda: _write(raw, ours, unpacked),
            "floor": lambda: _floor(study),
        }
        times = [{name: timed(way)[1] for name, way in ways.items()} for _ in range(repeats)]
        best, used = ({name: min(some[name][k] for some in times) for name in ways} for k in (0, 1))
        size = sum(array.nbytes for array in unpacked.values())
    return {
        "cases": float(study.cases),
        "cores": float(cores),
        "megabytes_unpacked": size / 1e6,
        **{f"seconds_{name}": some for name, some in best.items()},
        **{f"processor_seconds_{name}": some for name, some in used.items()},
        "step_speed_against_raw_write": best["raw"] / best["step"],
        "slab_speed_against_raw_write": best["raw"] / best["slab"],
        "slab_speed_against_raw_write_in_processor_time": used["raw"] / used["slab"],
        "cases_per_second": study.cases / best["step"],
        "megabytes_per_second": size / 1e6 / best["step"],
    }


def _step(levels: int, cores: int, folder: Path) -> None:
    """The slabs side by side, as the pipeline runs them."""
    code = "import sys; from benchmarks import dataset; dataset.one_of(*map(int, sys.argv[1:4]), sys.argv[4])"
    slabs = [
        subprocess.Popen(
            [sys.executable, "-c", code, str(levels), str(cores), str(k), str(folder / f"{k}.nc")], cwd=ROOT
        )
        for k in range(cores)
    ]
    codes = [slab.wait() for slab in slabs]
    if any(codes):
        raise RuntimeError("a slab failed")


def one_of(levels: int, slabs: int, index: int, path: str) -> None:
    """Write one of some slabs."""
    study = _part(levels)
    split = study.dataset.model_copy(update={"slabs": slabs})
    dataset.write_slab(study.model_copy(update={"dataset": split}), index, Path(path))


def _part(levels: int) -> Study:
    """Some levels of the first axis of the large study, in one slab."""
    study = load(ROOT / "config/large.yaml")
    first = next(iter(study.factors))
    axis = study.factors[first].model_copy(update={"levels": levels})
    unsplit = study.dataset.model_copy(update={"slabs": 1})
    return study.model_copy(update={"factors": {**study.factors, first: axis}, "dataset": unsplit})


def _contents(path: Path) -> dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]:
    data = read_whole(path)
    return {str(name): array.values for name, array in data.data_vars.items()}


def _write(path: Path, like: Path, arrays: dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]) -> None:
    """The same arrays with the same chunks and compression, a level at a time, and flushed to disk: nothing else."""
    with netCDF4.Dataset(like) as model, netCDF4.Dataset(path, "w") as file:
        for name, dim in model.dimensions.items():
            file.createDimension(name, dim.size)
        made = {}
        for name, array in arrays.items():
            chunks = model[name].chunking()
            made[name] = file.createVariable(
                name, array.dtype, model[name].dimensions, chunksizes=chunks, fill_value=False, **PACKED
            )
            made[name].set_auto_maskandscale(False)
        for level in range(next(iter(arrays.values())).shape[0]):
            for name, array in arrays.items():
                made[name][level : level + 1] = array[level : level + 1]
    handle = os.open(path, os.O_RDONLY)
    os.fsync(handle)
    os.close(handle)


def _floor(study: Study) -> None:
    """What no formula can do without: a power a material, friction and position; a logarithm a contact width."""
    axes = factorial.levels(study)
    X = study.dataset.positions.values()
    exponent = np.multiply.outer(axes["volume_fraction"], 0.1 + axes["friction"])
    np.power(np.abs((1 - X) / (1 + X)), exponent[..., None])
    widths = np.multiply.outer(exponent, np.multiply.outer(axes["radius"], axes["load"]))
    np.log(widths)


if __name__ == "__main__":
    print(printed(measure(*(int(word) for word in sys.argv[1:]))))
