"""Reads a whole netCDF file of unknown origin and refuses what is not plain.

It runs in a child process with limits (`storage.quarantine`), as a script or after a fork, and imports nothing of this
program. A hostile file can keep the HDF5 library busy for ever, make it take gigabytes or crash it, and a valid one can
name any other file of the machine as the source of its values.
"""

import ctypes
import os
import resource
import sys
from collections.abc import Iterator
from math import prod
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

SECONDS = 10
MEMORY = 2**30  # bytes of addresses, beyond those that the process has when it starts to read
MANY = 1000  # variables and dimensions, or attributes of one of them
TEXT = 2**16  # bytes of a text or an attribute
TEXTS = 2**22  # bytes of all of them together
NOT_PLAIN = 3  # exit status
#: Attributes that change values, and the memory that they take, when they are read.
DECODING = ("_FillValue", "missing_value", "scale_factor", "add_offset", "_Unsigned")
#: Attributes that the netCDF library writes itself.
OWN = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "_NCProperties", "_Netcdf4Coordinates", "_Netcdf4Dimid")
NUMBERS = [f"H5T_{kind}{end}_g" for end in ("LE", "BE") for kind in ("IEEE_F32", "IEEE_F64")]
NUMBERS += [f"H5T_STD_{sign}{bits}{end}_g" for end in ("LE", "BE") for sign in "IU" for bits in (8, 16, 32, 64)]

# of HDF5's enumerations H5D_layout_t, H5F_close_degree_t, H5I_type_t and H5T_class_t
_VIRTUAL, _STRONG, _DATASET, _STRING = 3, 3, 5, 3


class NotPlainError(Exception):
    """A file has contents that no file of this program has."""


class Hdf5:
    """Checks a file through the HDF5 library, before any value is read."""

    def __init__(self) -> None:
        self.library = ctypes.CDLL(sys.modules["netCDF4._netCDF4"].__file__)
        self.numbers = [self._constant(name) for name in NUMBERS]

    def check(self, path: Path) -> None:
        """Refuse everything but variables of plain numbers and texts with plain attributes, stored in the file."""
        access = self._call("H5Pcreate", self._constant("H5P_CLS_FILE_ACCESS_ID_g"))
        self._call("H5Pset_fclose_degree", access, _STRONG)
        file = self._call("H5Fopen", os.fsencode(path), 0, access)
        if file < 0:
            raise OSError("no HDF5 file")
        self._check_attributes(file, "the file")
        for name in self._names(file):
            # a link to another file cannot be opened: the process may open no other file
            opened = self._call("H5Oopen", file, name, 0)
            what = name.decode("utf-8", "replace")
            if opened < 0 or self._call("H5Iget_type", opened) != _DATASET:
                raise NotPlainError(f"{what!r} is not a variable but a group, a type or a link")
            self._check_variable(opened, what)
            self._check_attributes(opened, what)
        self._call("H5Fclose", file)

    def _names(self, file: int) -> list[bytes]:
        names, space = list[bytes](), ctypes.create_string_buffer(1024)
        while self._call("H5Lget_name_by_idx", file, b".", 0, 0, len(names), space, 1024, 0) >= 0:
            names.append(space.value)
            if len(names) > MANY:
                raise NotPlainError(f"more than {MANY} variables and dimensions")
        return names

    def _check_variable(self, variable: int, what: str) -> None:
        creation, kind = self._call("H5Dget_create_plist", variable), self._call("H5Dget_type", variable)
        if self._call("H5Pget_layout", creation) == _VIRTUAL or self._call("H5Pget_external_count", creation):
            raise NotPlainError(f"the values of variable {what!r} are stored elsewhere")
        if not self._is_number(kind) and self._call("H5Tis_variable_str", kind) <= 0:
            raise NotPlainError(f"variable {what!r} has an unexpected type")

    def _check_attributes(self, owner: int, what: str) -> None:
        space = ctypes.create_string_buffer(1024)
        for number in range(MANY + 1):
            attribute = self._call("H5Aopen_by_idx", owner, b".", 0, 0, number, 0, 0)
            if attribute < 0:
                return
            self._call("H5Aget_name", attribute, 1024, space)
            name = space.value.decode("utf-8", "replace")
            if self._call("H5Aget_storage_size", attribute) > TEXT:
                raise NotPlainError(f"attribute {name!r} of {what} takes more than {TEXT} bytes")
            kind = self._call("H5Aget_type", attribute)
            count = self._call("H5Sget_simple_extent_npoints", self._call("H5Aget_space", attribute))
            text = self._call("H5Tget_class", kind) == _STRING and count <= 1
            if name not in OWN and not text and not self._is_number(kind):
                raise NotPlainError(f"attribute {name!r} of {what} is neither one text nor numbers")
        raise NotPlainError(f"more than {MANY} attributes of {what}")

    def _is_number(self, kind: int) -> bool:
        return any(self._call("H5Tequal", kind, number) > 0 for number in self.numbers)

    def _call(self, name: str, *arguments: Any) -> int:
        """Call a function with handles, numbers, texts or buffers; negative is a failure."""
        function = getattr(self.library, name)
        function.restype = ctypes.c_int if name in _INT else ctypes.c_int64
        return int(function(*(ctypes.c_int64(value) if isinstance(value, int) else value for value in arguments)))

    def _constant(self, name: str) -> int:
        return ctypes.c_int64.in_dll(self.library, name).value


#: Functions of HDF5 that give an int; the others give a handle or a size of 64 bits.
_INT = ("H5Iget_type", "H5Pget_layout", "H5Pget_external_count", "H5Tequal", "H5Tis_variable_str", "H5Tget_class")


def addresses() -> int:
    """Bytes of addresses of this process; 0 where the system does not report them."""
    used = Path("/proc/self/statm")
    return int(used.read_text(encoding="ascii").split()[0]) * resource.getpagesize() if used.exists() else 0


def limit() -> None:
    """Limit time and memory of this process from here on, and let it open one more file at a time."""
    used = addresses()
    handle = os.open(os.devnull, os.O_RDONLY)
    os.close(handle)
    most = {
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_CPU: SECONDS,
        resource.RLIMIT_AS: used + MEMORY,
        resource.RLIMIT_NOFILE: handle + 1,
    }
    for kind, value in most.items():
        hard = resource.getrlimit(kind)[1]
        least = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(kind, (least, least))


def examine(path: Path, max_bytes: int) -> None:
    """Read a whole file; NotPlainError for unexpected contents, any error of the library for an unreadable file."""
    hdf5 = Hdf5()
    limit()
    hdf5.check(path)
    with netCDF4.Dataset(path, "r") as file:
        declared = sum(_size(variable) for variable in file.variables.values())
        if declared > max_bytes:
            raise NotPlainError(f"too large: it unpacks to {declared} bytes, at most {max_bytes} are read")
        file.set_auto_maskandscale(False)
        read = sum(_attributes(file)) + sum(sum(_attributes(variable)) for variable in file.variables.values())
        for name, variable in file.variables.items():
            read += sum(_bounded(f"a text of variable {name!r}", text) for text in _texts(variable[...]))
            if read > TEXTS:
                raise NotPlainError(f"its texts and attributes take more than {TEXTS} bytes")


def _size(variable: "netCDF4.Variable[Any]") -> int:
    itemsize = variable.dtype.itemsize if isinstance(variable.dtype, np.dtype) else 64
    return prod(map(int, variable.shape)) * itemsize


def _attributes(owner: "netCDF4.Dataset | netCDF4.Variable[Any]") -> Iterator[int]:
    """Yield the bytes of every attribute."""
    for name in owner.ncattrs():
        if name in DECODING:
            raise NotPlainError(f"unexpected attribute {name!r}")
        value = owner.getncattr(name)
        yield _bounded(f"attribute {name!r}", value) if isinstance(value, str) else np.asarray(value).nbytes


def _texts(values: object) -> Iterator[str]:
    array = np.asarray(values, dtype=object) if isinstance(values, str) else np.asarray(values)
    return (str(text) for text in array.flat) if array.dtype.kind in "OU" else iter(())


def _bounded(what: str, text: str) -> int:
    size = len(text.encode("utf-8", "surrogatepass"))
    if size > TEXT:
        raise NotPlainError(f"{what} takes more than {TEXT} bytes")
    return size


def outcome(path: Path, max_bytes: int) -> tuple[int, str]:
    """Return exit status and reason: 0 for a plain file, `NOT_PLAIN`, or 1 for an unreadable file."""
    try:
        examine(path, max_bytes)
    except NotPlainError as error:
        return NOT_PLAIN, str(error)
    except Exception as error:  # the library may raise any
        return 1, f"{type(error).__name__}: {error}"
    return 0, ""


def line(reason: str) -> bytes:
    """Return a reason in at most 300 characters, without control characters, which could command a terminal."""
    return "".join(sign if sign.isprintable() else "?" for sign in reason[:300]).encode("utf-8", "replace")


if __name__ == "__main__":
    status, reason = outcome(Path(sys.argv[1]), int(sys.argv[2]))
    os.write(1, line(reason))
    os._exit(status)  # whatever the library would still do with a spoilt file
