"""Further exact cases that a surrogate asks for, round by round: where they lie, and their files."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

import numpy as np
import xarray as xr

from approximation.arrays import Array
from storage.described import described
from storage.netcdf import read_whole, write_whole
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.data.points import EVEN
from workflow.dataset import factorial, holes
from workflow.dataset.casecache import CaseCache
from workflow.run.joblog import log
from workflow.study import partition
from workflow.study.model import Study

#: Rounds in which the cases of ``surrogate: budget`` are asked for, each from all that is known by then.
ROUNDS = 3
#: How far from a place cases are drawn, in half-widths of the box, and how many share the factors that need tables.
AROUND, TOGETHER = 0.05, 20
_SEED = 5


@dataclass(frozen=True)
class Place:
    """Where something wants a surer surrogate."""

    name: str  # What does
    doubt: float  # How unsure it is, by which places are asked for
    factors: Mapping[str, Array]  # Every factor of the study at the cases on which it rests, (n,) each


def names(study: Study) -> list[str]:
    """What asks for cases: every target, or where intervals are widest."""
    return list(study.design) or ["widest"]


def near(study: Study, place: Place, number: int) -> dict[str, xr.DataArray]:
    """Random factors of a round's cases over dimension ``case``, near cases on which a place rests.

    Each is drawn within `AROUND` of a random case of the place. Of films, `TOGETHER` cases share the factors that need
    tables.
    """
    count, together = _count(study, number), TOGETHER if study.tabled else 1
    drawn: dict[str, list[Array]] = {name: [] for name in study.factors}
    random = np.random.default_rng([study.validation.seed, _SEED, number, crc32(place.name.encode())])
    for _ in range(-(-count // together)):
        case = random.integers(next(iter(place.factors.values())).size)
        for axis in factorial.inputs(study):
            t = axis.to_unit(place.factors[axis.name][[case]])
            away = random.uniform(-AROUND, AROUND, 1 if axis.name in study.tabled else together)
            # what would lie beyond the box is drawn inside of its end instead
            shifted = np.where(np.abs(t + away) > 1, t - away, t + away)
            drawn[axis.name].append(np.broadcast_to(axis.from_unit(np.clip(shifted, -1, 1)), together))
    return {name: xr.DataArray(np.concatenate(parts)[:count], dims="case") for name, parts in drawn.items()}


def _count(study: Study, number: int) -> int:
    whole = study.surrogate.budget or 0
    return whole * (number + 1) // ROUNDS - whole * number // ROUNDS


def write(study: Study, place: Place, number: int, path: Path) -> None:
    """Write the factors of a round's cases, or none where there is no doubt left."""
    log.info("%s: 95 %% intervals within %.2g of the value or the limit", place.name, place.doubt)
    until = study.surrogate.until
    cases = {} if until is not None and place.doubt <= until else near(study, place, number)
    title = "cases that a surrogate asks for, and how unsure it was where it does"
    write_whole(described(xr.Dataset({**cases, "doubt": place.doubt}), title, SOURCE, MEANINGS | _MEANINGS), path)


_MEANINGS = {"doubt": "largest half-width of a 95 % interval, of the goal over its value, of a limit over its scale"}


def slabs(study: Study, path: str | Path) -> int:
    """Number of files that hold the cases of a round; 0 of one that asks for none."""
    return min(partition.count(study), -(-read_whole(Path(path)).sizes.get("case", 0) // TOGETHER))


def write_slab(study: Study, path_of_cases: Path, index: int, path: Path, cache: CaseCache | None = None) -> None:
    """Solve a part of a round's cases exactly, and write them; those that the solver refuses are masked."""
    cases = read_whole(path_of_cases)
    places = np.arange(cases.sizes["case"]) // TOGETHER
    part = np.isin(places, np.array_split(np.unique(places), slabs(study, path_of_cases))[index])
    points = {name: xr.DataArray(cases[name].values[part], dims="case") for name in study.factors}
    solved = factorial.exact(study, points, holes=np.inf, cache=cache)
    write_whole(solved.assign_coords({EVEN: ("case", np.full(solved.sizes["case"], -1, np.int8))}), path)


def gathered(slabs: Sequence[xr.Dataset]) -> xr.Dataset:
    """All cases that a target asks for, over ``case``; nothing where it asks for none."""
    return holes.joined(slabs, "case") if slabs else xr.Dataset()


def joined(calibration: xr.Dataset, further: Sequence[xr.Dataset]) -> xr.Dataset:
    """Cases for calibration with those that were asked for, which are not spread evenly."""
    further = [cases for cases in further if "case" in cases.dims]
    if not further:
        return calibration
    even = calibration.get(EVEN, xr.DataArray(np.ones(calibration.sizes["case"], np.int8), dims="case"))
    return holes.joined([calibration.assign_coords({EVEN: even}), *further], "case")
