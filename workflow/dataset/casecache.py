"""A cache of solved cases of all studies, stored by their content beside the results.

A piece is solved in one call: the cases of films that share their tables, else the cases at one level of the data set's
first axis, or some of a list. Every piece is solved alone, with a cache or without, so that no bit of a result depends
on the cache. Cases that cost microseconds are not stored: reading takes as long.
"""

import hashlib
import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from itertools import pairwise, product
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from storage.described import standard
from storage.netcdf import CHECKSUM, read_whole, write_whole
from storage.sealed import PARTIAL, FormatError
from workflow.run import lock, provenance
from workflow.run.joblog import log
from workflow.study.model import Study

if TYPE_CHECKING:
    from snakemake.iocontainers import Snakemake

#: Folder of stored cases below that of all results, and their largest size: the last used ones stay.
FOLDER, MOST_BYTES = ".solved", 2**31
#: Attribute of an answer: the digest of everything that decides it, which also names its file.
CASE = "case_sha256"
_OF_CASES = "cases"
_DAY = 86400.0
#: Cases of a list that are solved at once where none needs tables of its own.
AT_A_TIME = 50

Solved = Callable[[Mapping[str, Any]], xr.Dataset]
_Cases = Mapping[str, xr.DataArray]
_Part = dict[str, slice]


class CaseCache:
    """Cache beside the results, for one job, with the counts of cases requested and taken from it."""

    def __init__(self, results: Path) -> None:
        self.folder = results / FOLDER
        self.cases = self.taken = 0

    def around(self, study: Study, solved: Solved, options: Mapping[str, Any]) -> Solved:
        """Return a function that solves cases piece by piece and takes stored pieces from the cache."""
        if not study.costly & set(study.quantities):
            return solved
        question = json.dumps([study.digest("phases", "materials", "body"), options, _solver()], sort_keys=True)

        def whole(factors: Mapping[str, Any]) -> xr.Dataset:
            cases = {name: labelled(name, value) for name, value in factors.items()}
            parts = list(_parts(study, cases))
            answers = [self._piece(solved, question, selected(cases, part)) for part in parts]
            return answers[0] if len(answers) == 1 else assembled(list(zip(parts, answers, strict=True)), sizes(cases))

        return whole

    def _piece(self, solved: Solved, question: str, cases: Mapping[str, xr.DataArray]) -> xr.Dataset:
        """Return the answer of one piece, from its file if that is whole."""
        name = _digest(question, cases)
        path = self.folder / _OF_CASES / name[:2] / f"{name[2:]}.nc"
        count = prod(sizes(cases).values())
        try:
            answer = _as_solved(read_whole(path, max_bytes=MOST_BYTES), name)
            os.utime(path)
        except (OSError, FormatError):  # no file, an incomplete one, or that of another case
            answer = solved(cases)
            _write(answer.assign_attrs({CASE: name}), path)
        else:
            self.taken += count
        self.cases += count
        return answer


@contextmanager
def of(job: "Snakemake") -> Iterator[CaseCache]:
    """Yield the cache for a job, whose rule has the wildcard ``study``; log how many cases it had."""
    cache = CaseCache(lock.results(job.wildcards.study, Path(job.output[0])))
    yield cache
    if cache.cases:
        log.info("%d of %d cases were solved before", cache.taken, cache.cases)


def sweep(results: Path, most: int = MOST_BYTES) -> None:
    """Remove the files that were used longest ago, and partial files of killed writers."""
    clock, files = time.time(), []
    for file in (results / FOLDER / _OF_CASES).rglob("*"):
        try:
            status = file.stat()
        except OSError:  # another run sweeps too
            continue
        if file.name.endswith(PARTIAL) and clock - status.st_mtime > _DAY:
            file.unlink(missing_ok=True)
        elif file.suffix == ".nc":
            files.append((status.st_mtime, status.st_size, file))
    total = sum(size for _, size, _ in files)
    for _, size, file in sorted(files):
        if total <= most:
            break
        file.unlink(missing_ok=True)
        total -= size


@cache
def _solver() -> str:
    """Return what decides an answer beside its case: a hash of the solver's sources, and versions of its packages."""
    sources = [file.relative_to(provenance.ROOT).as_posix() for file in (provenance.ROOT / "solver").rglob("*.py")]
    versions = provenance.versions()
    return " ".join(
        [provenance.code(*sorted(sources), "workflow/study/layered.py"), versions["numpy"], versions["scipy"]]
    )


def _digest(question: str, cases: Mapping[str, xr.DataArray]) -> str:
    """Return a hash of the values of all factors, to the last bit, over their dimensions."""
    digest = hashlib.sha256(question.encode())
    for name, array in cases.items():
        digest.update(json.dumps([name, list(map(str, array.dims)), list(array.shape)]).encode())
        values = array.values
        text = values.dtype.kind not in "iufb"
        digest.update(json.dumps(values.tolist()).encode() if text else np.asarray(values, dtype=np.float64).tobytes())
    return digest.hexdigest()


def _parts(study: Study, cases: Mapping[str, xr.DataArray]) -> Iterator[_Part]:
    """Yield the regions of the pieces: runs of equal values of tabled factors, or levels of the first axis."""
    names = [name for name in study.tabled if name in cases]
    dims = list(dict.fromkeys(str(dim) for name in names for dim in cases[name].dims))
    runs = {dim: _runs([cases[name] for name in names if dim in cases[name].dims], dim) for dim in dims}
    if not names:
        first, lengths = next(iter(study.axes)), sizes(cases)
        dim, step = (first, 1) if first in lengths else (next(iter(lengths), ""), AT_A_TIME)
        runs = {dim: [slice(k, k + step) for k in range(0, lengths[dim], step)]} if lengths else {}
    for region in product(*runs.values()):
        yield dict(zip(runs, region, strict=True))


def _runs(factors: Sequence[xr.DataArray], dim: str) -> list[slice]:
    """Return the runs along a dimension in which some factors stay the same."""
    firsts = [factor.isel({other: 0 for other in factor.dims if other != dim}) for factor in factors]
    rows = np.stack([first.values for first in firsts], axis=-1)
    ends = np.flatnonzero((rows[1:] != rows[:-1]).any(axis=-1)) + 1
    starts = [0, *ends.tolist(), len(rows)]
    return [slice(begin, end) for begin, end in pairwise(starts)]


def _write(answer: xr.Dataset, path: Path) -> None:
    """Store an answer; log a warning where the file system refuses."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(answer, path)
    except OSError as error:
        log.warning("solved cases are not kept: %s", error)


def _as_solved(stored: xr.Dataset, name: str) -> xr.Dataset:
    """Return an answer without the attributes of files; FormatError if it answers another case."""
    if stored.attrs.get(CASE) != name:
        raise FormatError(name, "is no answer to this case")
    attributes_of_files = {*standard(stored), CHECKSUM, CASE}
    stored.attrs = {name: value for name, value in stored.attrs.items() if name not in attributes_of_files}
    return stored.drop_encoding()


def assembled(parts: Sequence[tuple[_Part, xr.Dataset]], whole_sizes: Mapping[str, int]) -> xr.Dataset:
    """Return cases of several regions in one data set, without variables that a part lacks; NaN between the parts."""
    first_region, first = parts[0]
    shared = first[[name for name in first.data_vars if all(name in part for _, part in parts)]]
    variables: dict[str, xr.Variable] = {}
    for name, variable in shared.variables.items():
        if not set(first_region).isdisjoint(map(str, variable.dims)):
            shape = [whole_sizes.get(str(dim), variable.sizes[dim]) for dim in variable.dims]
            values = np.full(shape, np.nan if variable.dtype.kind == "f" else 0, variable.dtype)
            for region, part in parts:
                values[tuple(region.get(str(dim), slice(None)) for dim in variable.dims)] = part[name].values
            variable = xr.Variable(variable.dims, values, variable.attrs)
        variables[str(name)] = variable
    coords = {name: variable for name, variable in variables.items() if name in shared.coords}
    return xr.Dataset({name: variables[name] for name in map(str, shared.data_vars)}, coords, shared.attrs)


def sizes(cases: _Cases) -> dict[str, int]:
    """Return the length of every dimension of some cases."""
    return {str(dim): size for array in cases.values() for dim, size in array.sizes.items()}


def selected(cases: _Cases, region: Mapping[str, slice]) -> dict[str, xr.DataArray]:
    """Return the cases of a region."""
    return {name: array.isel(region, missing_dims="ignore") for name, array in cases.items()}


def labelled(name: str, value: ArrayLike | xr.DataArray) -> xr.DataArray:
    """Return the values of a factor as an array; a sequence lies along the factor itself."""
    return value if isinstance(value, xr.DataArray) else xr.DataArray(np.asarray(value), dims=(name,) * np.ndim(value))
