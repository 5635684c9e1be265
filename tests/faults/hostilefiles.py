"""Hostile netCDF files, made through the C interface of the HDF5 library that the netCDF library brings along."""

import ctypes
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from storage import examined
from storage.sealed import seal

_LIBRARY = ctypes.CDLL(sys.modules["netCDF4._netCDF4"].__file__)
_LENGTH = 100
_TEXTS = 4000


def _call(name: str, *arguments: Any) -> int:
    """Call a function of HDF5 with numbers, texts as bytes and arrays; its result, or a test that fails."""
    function = getattr(_LIBRARY, name)
    function.restype = ctypes.c_int64
    plain = [ctypes.c_int64(argument) if isinstance(argument, int) else argument for argument in arguments]
    done = int(function(*plain))
    assert ctypes.c_int32(done).value >= 0, name
    return done


def _constant(name: str) -> int:
    return ctypes.c_int64.in_dll(_LIBRARY, name).value


def _space(length: int = _LENGTH) -> int:
    return _call("H5Screate_simple", 1, (ctypes.c_uint64 * 1)(length), None)


def _dataset(
    file: int, name: bytes = b"x", kind: int | None = None, creation: int = 0, space: int | None = None
) -> int:
    kind = _constant("H5T_NATIVE_DOUBLE_g") if kind is None else kind
    return _call("H5Dcreate2", file, name, kind, _space() if space is None else space, 0, creation, 0)


def _creation() -> int:
    return _call("H5Pcreate", _constant("H5P_CLS_DATASET_CREATE_ID_g"))


def _external(file: int) -> None:
    creation = _creation()
    _call("H5Pset_external", creation, b"fifo", 0, 8 * _LENGTH)
    _dataset(file, creation=creation)


def _virtual(file: int) -> None:
    _dataset(file, b"y")
    creation, space = _creation(), _space()
    _call("H5Pset_virtual", creation, space, b"secret.nc", b"y", space)
    _dataset(file, creation=creation, space=space)


def _long_double(file: int) -> int:
    return _dataset(file, kind=_constant("H5T_NATIVE_LDOUBLE_g"))


def _text_kind() -> int:
    kind = _call("H5Tcopy", _constant("H5T_C_S1_g"))
    _call("H5Tset_size", kind, -1)  # of any length
    return kind


def _texts(file: int, length: int = 2**21, count: int = _TEXTS) -> None:
    """An attribute of one long text and many empty ones; `_one_for_all` lets them all point to the long one."""
    kind, owner = _text_kind(), _dataset(file)
    attribute = _call("H5Acreate2", owner, b"a", kind, _space(count), 0, 0)
    texts = (ctypes.c_char_p * count)(b"t" * length, *[b"s"] * (count - 1))
    _call("H5Awrite", attribute, kind, texts)
    _call("H5Aclose", attribute)


def _variable_of_texts(file: int, count: int = _TEXTS) -> None:
    kind = _text_kind()
    owner = _dataset(file, kind=kind, space=_space(count))
    _call("H5Dwrite", owner, kind, 0, 0, 0, (ctypes.c_char_p * count)(b"t" * 60000, *[b"s"] * (count - 1)))


def _one_for_all(content: bytes) -> bytes:
    """Let every text that has one letter point to the first, which is long: a reference is 16 bytes."""
    numbers = np.frombuffer(content + bytes(-len(content) % 4), "<u4")
    shorts = np.flatnonzero((numbers[:-7] == 1) & (numbers[4:-3] == 1) & (numbers[1:-6] == numbers[5:-2]))
    start = 4 * (int(shorts[0]) - 4)
    spoilt = bytearray(content)
    for place in range(start, start + 16 * _TEXTS, 16):
        spoilt[place : place + 16] = content[start : start + 16]
    return bytes(spoilt)


#: What is added to an empty file, and what is said of the file.
ATTACKS: dict[str, tuple[Callable[[int], object], str]] = {
    "fifo": (_external, "the values of variable 'x' are stored elsewhere"),
    "virtual": (_virtual, "the values of variable 'x' are stored elsewhere"),
    "link": (lambda file: _call("H5Lcreate_external", b"s.nc", b"x", file, b"x", 0, 0), "'x' is not a variable"),
    "long_double": (_long_double, "variable 'x' has an unexpected type"),
    "texts": (_texts, "attribute 'a' of x is neither one text nor numbers"),
    "one_long_text": (lambda file: _texts(file, 2**17, 1), "attribute 'a' takes more than 65536 bytes"),
    "variable_of_texts": (_variable_of_texts, "its texts and attributes take more than 4194304 bytes"),
}


def endless(*_: object) -> None:
    """Replace `examined.examine`, as the next two do: a file that keeps the library busy."""
    examined.limit()
    while True:
        pass


def crash(*_: object) -> None:
    """A file that crashes the library."""
    os.abort()


def greedy(*_: object) -> None:
    """A file that makes the library take memory."""
    examined.limit()
    bytearray(2 * examined.MEMORY)


def write(name: str, path: Path) -> None:
    """Write one of `ATTACKS`, sealed; in the current folder a FIFO and a file that it may name."""
    Path("secret").write_bytes(bytes(8 * _LENGTH))
    if not Path("fifo").exists():
        os.mkfifo("fifo")
    access = _call("H5Pcreate", _constant("H5P_CLS_FILE_ACCESS_ID_g"))
    # headers as of old, without checksums, but for a virtual dataset, which they do not have
    _call("H5Pset_libver_bounds", access, 3 if name == "virtual" else 0, 3)
    _call("H5Pset_fclose_degree", access, 3)  # with everything in it
    file = _call("H5Fcreate", os.fsencode(path), 2, 0, access)
    ATTACKS[name][0](file)
    _call("H5Fclose", file)
    if name in ("texts", "variable_of_texts"):
        path.write_bytes(_one_for_all(path.read_bytes()))
    seal(path)
