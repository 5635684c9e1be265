"""netCDF-4 files that appear whole or not at all, and are verified when read.

A killed netCDF-4 writer leaves a file that opens. Therefore a file is written under a temporary name in the same
folder, sealed as the very last step, flushed to disk and only then renamed. The seal is the length and SHA-256 of the
file, in 48 bytes behind its end, where every netCDF reader ignores them; it is verified before the HDF5 library sees
the file, since single flipped bytes were measured to crash that library (2 in 1,000).
"""

import hashlib
import json
import os
import secrets
import struct
from collections.abc import Hashable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

CHECKSUM = "checksum"
# Arrays below this size gain nothing from compression.
COMPRESS_FROM = 4096
MAX_BYTES = 16 * 2**30
# What one string of a variable-length array takes in memory, at least.
STRING_BYTES = 64
SEAL = struct.Struct("<8sQ32s")
MAGIC = b"\x89whole\r\n"
FAILURES = (
    OSError,
    RuntimeError,
    ValueError,
    KeyError,
    TypeError,
    AttributeError,
    IndexError,
    OverflowError,
    MemoryError,
)


class FormatError(ValueError):
    """A file is not what it should be: incomplete, altered, too large, or of an unknown kind or version."""

    def __init__(self, path: str | PathLike[str], reason: str) -> None:
        super().__init__(f"{os.fspath(path)}: {' '.join(reason.split())}")


def write_whole(
    dataset: xr.Dataset, path: str | PathLike[str], encoding: Mapping[Hashable, Mapping[str, Any]] | None = None
) -> None:
    """Write a data set to a netCDF-4 file that appears whole or not at all.

    The attribute `checksum` is the SHA-256 of the names, dimensions, attributes and bytes of all variables. Equal data
    sets give equal bytes. Large float arrays are compressed (Blosc: byte shuffle, Zstandard level 1).

    Parameters
    ----------
    dataset : Dataset
        Numbers, booleans and strings; no times, and no encoding of its own (it is dropped).
    path : path-like
        Where to; its folder must exist. An existing file is replaced.
    encoding : mapping, optional
        netCDF encoding by variable, beyond the default; it must be lossless, or the file fails its checksum.

    Raises
    ------
    FileNotFoundError
        The folder does not exist.
    TypeError
        A variable or attribute of a kind that the file cannot hold.
    OSError
        No room or no permission, in the system's words, with the file.
    """
    path = Path(path)
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path}: the folder {path.parent} does not exist")
    plain = dataset.drop_encoding()
    plain.attrs.pop(CHECKSUM, None)
    plain.attrs.setdefault("Conventions", "CF-1.11")
    mark = checksum(plain)
    settings = {name: _encoding(variable) for name, variable in plain.variables.items()}
    for name, extra in (encoding or {}).items():
        settings[name] |= extra
    partial = path.with_name(f".{path.name}.{os.getpid()}.{secrets.token_hex(4)}.partial")
    try:
        plain.to_netcdf(partial, mode="w", format="NETCDF4", engine="netcdf4", encoding=settings)
        with netCDF4.Dataset(partial, "a") as file:
            file.setncattr(CHECKSUM, mark)
        seal(partial)
        _flush(partial)
        partial.replace(path)
        _flush(path.parent)
    except (OSError, RuntimeError) as error:
        raise _explained(error, partial, path) from error
    finally:
        partial.unlink(missing_ok=True)


def _explained(error: OSError | RuntimeError, partial: Path, path: Path) -> OSError | RuntimeError:
    """The system's reason (disk full, quota, permission) where the netCDF library only says that it failed."""
    if isinstance(error, OSError) and (error.errno or 0) > 0:
        return OSError(error.errno, error.strerror, os.fspath(path))
    try:
        with partial.open("ab") as file:
            file.write(bytes(2**20))
            _flush(partial)
    except OSError as cause:
        return OSError(cause.errno, cause.strerror, os.fspath(path))
    return error


def read_whole(path: str | PathLike[str], lazy: bool = False, max_bytes: int = MAX_BYTES) -> xr.Dataset:
    """Read a file of `write_whole`.

    Parameters
    ----------
    path : path-like
        The file.
    lazy : bool
        Only check that the file is complete, not that it is unaltered, and leave the arrays on disk; close the data
        set after use. By default everything is loaded and verified.
    max_bytes : int
        Refuse a file that is, or unpacks to, more than this.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    FormatError
        The file is no netCDF-4, truncated, incomplete, altered or too large; one line with file and reason.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    _check_seal(path, lazy, max_bytes)
    mark = _inspect(path, max_bytes)
    with _reported(path):
        dataset = xr.open_dataset(path, engine="netcdf4", decode_times=False, decode_timedelta=False)
    if lazy:
        return dataset
    with dataset, _reported(path):
        loaded = dataset.load()
        found = checksum(loaded)
    if found != mark:
        raise FormatError(path, "altered: its contents do not match their checksum")
    return loaded


def checksum(dataset: xr.Dataset) -> str:
    """Return the SHA-256 over the names, dimensions, attributes and bytes of all variables, in hexadecimal."""
    digest = hashlib.sha256(_attributes({k: v for k, v in dataset.attrs.items() if k != CHECKSUM}))
    for name in sorted(dataset.variables, key=str):
        variable = dataset.variables[name]
        head = [str(name), [str(dim) for dim in variable.dims], list(variable.shape)]
        digest.update(json.dumps(head).encode())
        digest.update(_attributes(variable.attrs))
        values = variable.to_numpy()
        if values.dtype.kind in "biuf":
            little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
            digest.update(little.dtype.str.encode())
            digest.update(little.data)
        elif all(isinstance(one, str) for one in values.astype(object).flat):
            digest.update(json.dumps([str(one) for one in values.flat]).encode())
        else:
            raise TypeError(
                f"variable {name!r}: cannot store {values.dtype} values; numbers, booleans and strings only"
            )
    return digest.hexdigest()


def seal(path: Path) -> None:
    """Mark a file as complete: append its length and digest."""
    length = path.stat().st_size
    with path.open("ab") as file:
        file.write(SEAL.pack(MAGIC, length, _digest(path, length)))


def _check_seal(path: Path, lazy: bool, max_bytes: int) -> None:
    size = path.stat().st_size
    if size > max_bytes:
        raise FormatError(path, f"too large: {size} bytes, at most {max_bytes} are read")
    with path.open("rb") as file:
        file.seek(max(0, size - SEAL.size))
        end = file.read()
    magic, length, digest = SEAL.unpack(end) if len(end) == SEAL.size else (b"", 0, b"")
    if magic != MAGIC or length != size - SEAL.size:
        raise FormatError(path, "incomplete: it has no seal at its end, so it is truncated or not of this program")
    if not lazy and digest != _digest(path, length):
        raise FormatError(path, "altered: its bytes do not match its seal")


def _digest(path: Path, length: int) -> bytes:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while length > 0 and (part := file.read(min(length, 2**20))):
            digest.update(part)
            length -= len(part)
    return digest.digest()


def _attributes(attrs: Mapping[Any, Any]) -> bytes:
    def plain(value: object) -> object:
        # netCDF has no scalars beside arrays of length one
        return value if isinstance(value, str) else np.atleast_1d(np.asarray(value)).tolist()

    return json.dumps({str(key): plain(attrs[key]) for key in sorted(attrs, key=str)}).encode()


def _encoding(variable: xr.Variable) -> dict[str, Any]:
    if variable.dtype.kind != "f":
        return {}
    # netCDF4 ignores `shuffle` beside "zstd"; without it floating-point numbers hardly pack, hence Blosc's
    packed = {"compression": "blosc_zstd", "complevel": 1, "blosc_shuffle": 1}
    return {"_FillValue": None, **(packed if variable.size >= COMPRESS_FROM else {})}


def _inspect(path: Path, max_bytes: int) -> str:
    """Check sizes in the header alone, before anything is loaded; return the checksum."""
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
    count = 1
    for length in variable.shape:
        count *= int(length)
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


def _flush(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
