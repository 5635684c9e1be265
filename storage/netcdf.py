"""netCDF-4 files that appear whole or not at all, and are verified when read.

A killed netCDF-4 writer leaves a file that opens. Therefore a file is written under a temporary name in the same
folder, sealed as the very last step, flushed to disk and only then renamed (`storage.sealed`).
"""

import hashlib
import json
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from math import prod
from os import PathLike
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from storage.described import as_meant, as_stored, standard
from storage.sealed import FormatError, appearing, check_seal

CHECKSUM = "checksum"
#: Attribute of a job's file: the question that its content answers, see `bind`.
ANSWERS = "answers"
COMPRESS_FROM = 4096  # values; smaller arrays gain nothing from compression
# every netCDF library reads zlib; Debian's has neither Blosc nor Zstandard
PACKED: dict[str, Any] = {"compression": "zlib", "complevel": 1, "shuffle": True}
MAX_BYTES = 16 * 2**30
STRING_BYTES = 64  # least memory of a string in an array
FAILURES = (OSError, RuntimeError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError, MemoryError)


_written: dict[Path, str] = {}  # attribute `answers` of the files that this process writes
_checks: dict[Path, Callable[[Path, str], None]] = {}  # checks of that attribute in files that this process reads


def bind(written: Mapping[Path, str], checks: Mapping[Path, Callable[[Path, str], None]]) -> None:
    """Set the attribute `answers` of files that this process will write, and its checks in files that it will read."""
    _written.clear()
    _checks.clear()
    _written.update({path.absolute(): answers for path, answers in written.items()})
    _checks.update({path.absolute(): check for path, check in checks.items()})


def purpose(path: Path) -> dict[str, str]:
    """Return the attribute `answers` of a file that was named to `bind`, otherwise none."""
    answers = _written.get(path.absolute())
    return {} if answers is None else {ANSWERS: answers}


def _without_purpose(dataset: xr.Dataset, path: Path) -> xr.Dataset:
    """Check the attribute `answers` and return the data without it."""
    answers = dataset.attrs.pop(ANSWERS, "")
    if check := _checks.get(path.absolute()):
        check(path, str(answers))
    return as_meant(dataset)


def write_whole(dataset: xr.Dataset, path: str | PathLike[str]) -> None:
    """Write a data set, with its `checksum`, to a netCDF-4 file that appears whole or not; equal data, equal bytes."""
    plain = as_stored(dataset.drop_encoding())
    plain.attrs.pop(CHECKSUM, None)
    plain.attrs |= standard(plain) | purpose(Path(path))
    mark = checksum(plain)
    with appearing(Path(path), sealed=True) as partial:
        plain.to_netcdf(partial, mode="w", format="NETCDF4", engine="netcdf4", encoding=encodings(plain))
        with netCDF4.Dataset(partial, "a") as file:
            file.setncattr(CHECKSUM, mark)


def read_whole(
    path: str | PathLike[str],
    lazy: bool = False,
    max_bytes: int = MAX_BYTES,
    names: Collection[str] | None = None,
) -> xr.Dataset:
    """Read a file of `write_whole` or `write_blocks`: all of it, verified, or lazily, or the variables `names`."""
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: {'is a folder' if path.is_dir() else 'no such file'}")
    check_seal(path, max_bytes)
    mark = _inspect(path, max_bytes)
    with _reported(path):
        dataset = xr.open_dataset(path, engine="netcdf4", decode_times=False, decode_timedelta=False)
    if lazy:
        return _without_purpose(dataset, path)
    with dataset, _reported(path):
        wanted = dataset if names is None else dataset[[name for name in dataset.data_vars if name in names]]
        loaded = wanted.load()
        if names is None and checksum(loaded) != mark:
            raise FormatError(path, "altered: its contents do not match their checksum")
    return _without_purpose(loaded, path)


def checksum(dataset: xr.Dataset) -> str:
    """Return the SHA-256 over the names, dimensions, attributes and bytes of all variables, in hexadecimal."""
    return combined(checksum_parts(dataset), dataset.attrs)


def checksum_parts(dataset: xr.Dataset) -> dict[str, str]:
    """Digest of every variable."""
    digests = {}
    for name, variable in dataset.variables.items():
        digest = started(variable.dims, variable.shape, variable.dtype)
        try:
            digest.update(contents(variable.to_numpy()))
        except TypeError as error:
            raise TypeError(f"variable {name!r}: {error}") from None
        digests[str(name)] = finished(digest, variable.attrs)
    return digests


def started(dims: Iterable[Hashable], shape: Iterable[int], dtype: np.dtype[Any]) -> "hashlib._Hash":
    """Return the digest of a variable's shape, to be updated with its contents, in pieces where it is large."""
    kind = dtype.newbyteorder("<").str if dtype.kind in "biuf" else "text"
    return hashlib.sha256(json.dumps([[str(dim) for dim in dims], list(shape), kind]).encode())


def contents(values: np.ndarray[Any, Any]) -> memoryview | bytes:
    """Return the bytes of numbers or strings for a digest."""
    if values.dtype.kind in "biuf":
        return np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).data
    if all(isinstance(text, str) for text in values.astype(object).flat):
        return json.dumps([str(text) for text in values.flat]).encode()
    raise TypeError(f"cannot store {values.dtype} values; numbers, booleans and strings only")


def finished(digest: "hashlib._Hash", attrs: Mapping[Any, Any]) -> str:
    """Digest of a variable with its attributes."""
    digest.update(_attributes(attrs))
    return digest.hexdigest()


def combined(digests: Mapping[str, str], attrs: Mapping[Any, Any]) -> str:
    """Digest of a whole data set from those of its variables."""
    attributes = {key: value for key, value in attrs.items() if key != CHECKSUM}
    return hashlib.sha256(json.dumps(sorted(digests.items())).encode() + _attributes(attributes)).hexdigest()


def _attributes(attrs: Mapping[Any, Any]) -> bytes:
    def plain(value: object) -> object:
        # netCDF has no scalars beside arrays of length one
        return value if isinstance(value, str) else np.atleast_1d(np.asarray(value)).tolist()

    return json.dumps({str(key): plain(attrs[key]) for key in sorted(attrs, key=str)}).encode()


def encodings(dataset: xr.Dataset) -> dict[Hashable, dict[str, Any]]:
    """Encoding of every variable: large float arrays are compressed, and no number marks a missing value."""
    return {
        name: {"_FillValue": None, **(PACKED if variable.size >= COMPRESS_FROM else {})}
        if variable.dtype.kind == "f"
        else {}
        for name, variable in dataset.variables.items()
    }


def _inspect(path: Path, max_bytes: int) -> str:
    """Check the sizes in the header, before any value is loaded, and return the checksum."""
    with _reported(path), netCDF4.Dataset(path, "r") as file:
        declared = sum(_size(path, variable) for variable in file.variables.values())
        unlimited = [name for name, dim in file.dimensions.items() if dim.isunlimited()]
        mark = file.getncattr(CHECKSUM) if CHECKSUM in file.ncattrs() else None
    if declared > max_bytes:
        raise FormatError(path, f"too large: it unpacks to {declared} bytes, at most {max_bytes} are read")
    if unlimited:
        raise FormatError(path, f"unexpected unlimited dimension {unlimited[0]!r}")
    if not isinstance(mark, str):
        raise FormatError(path, "it has no checksum, so it is not of this program")
    return mark


def _size(path: Path, variable: "netCDF4.Variable[Any]") -> int:
    count = prod(map(int, variable.shape))
    if variable.dtype is str:
        return count * STRING_BYTES
    if not isinstance(variable.dtype, np.dtype) or variable.dtype.kind not in "iuf":
        raise FormatError(path, f"variable {variable.name!r} has an unexpected type")
    return count * int(variable.dtype.itemsize)


@contextmanager
def _reported(path: Path) -> Iterator[None]:
    try:
        yield
    except FormatError:
        raise
    except FAILURES as error:
        raise FormatError(path, f"no readable netCDF-4 file ({error})") from error
