"""Files that appear whole or not at all, sealed by 48 bytes at their end with their length and SHA-256.

Every netCDF reader ignores the seal. It is verified before the HDF5 library sees the file, since altered bytes can keep
the library busy for ever (measured: 3 in 15,000 files with a few bytes changed and sealed again).
"""

import hashlib
import os
import secrets
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path

SEAL = struct.Struct("<8sQ32s")  # MAGIC, length, SHA-256
PARTIAL = ".partial"  # ending of the hidden name of a file that is being written
MAGIC = b"\x89whole\r\n"


class FormatError(ValueError):
    """A file is incomplete, altered, too large, or of an unknown kind or version."""

    def __init__(self, path: str | PathLike[str], reason: str) -> None:
        super().__init__(f"{os.fspath(path)}: {' '.join(reason.split())}")


@contextmanager
def appearing(path: Path, *, sealed: bool = False) -> Iterator[Path]:
    """Yield a temporary name in the same folder; the file written there is flushed and renamed in the end."""
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path}: the folder {path.parent} does not exist")
    partial = path.with_name(f".{path.name}.{os.getpid()}.{secrets.token_hex(4)}{PARTIAL}")
    try:
        yield partial
        if sealed:
            seal(partial)
        _flush(partial)
        partial.replace(path)
        _flush(path.parent)
    except (OSError, RuntimeError) as error:
        if explained := _explained(error, partial, path):
            raise explained from error
        raise
    finally:
        partial.unlink(missing_ok=True)


def seal(path: Path) -> None:
    """Mark a file as complete: append its length and digest."""
    length = path.stat().st_size
    mark = SEAL.pack(MAGIC, length, sha256(path, length))
    with path.open("ab") as file:
        file.write(mark)


def check_seal(path: Path, max_bytes: int, *, digest: bool = True) -> str:
    """Refuse a file that is too large, incomplete or altered, by :class:`FormatError`."""
    size = path.stat().st_size
    if size > max_bytes:
        raise FormatError(path, f"too large: {size} bytes, at most {max_bytes} are read")
    with path.open("rb") as file:
        file.seek(max(0, size - SEAL.size))
        end = file.read()
    magic, length, stored = SEAL.unpack(end) if len(end) == SEAL.size else (b"", 0, b"")
    if magic != MAGIC or length != size - SEAL.size:
        raise FormatError(path, "incomplete: it has no seal at its end, so it is truncated or not of this program")
    if digest and stored != sha256(path, length):
        raise FormatError(path, "altered: its bytes do not match its seal")
    return str(stored.hex())


def sha256(path: Path, length: int | None = None) -> bytes:
    """SHA-256 of the first `length` bytes of a file, or of all of it."""
    digest, left = hashlib.sha256(), path.stat().st_size if length is None else length
    with path.open("rb") as file:
        while left > 0 and (part := file.read(min(left, 2**20))):
            digest.update(part)
            left -= len(part)
    return digest.digest()


def _explained(error: OSError | RuntimeError, partial: Path, path: Path) -> OSError | None:
    """Return the system's reason (disk full, quota, permission) with the final name; None if it is of another file."""
    if isinstance(error, OSError) and (error.errno or 0) > 0:
        other = error.filename is not None and partial.name not in str(error.filename)
        return None if other else OSError(error.errno, error.strerror, os.fspath(path))
    try:  # the netCDF library only says that it failed
        with partial.open("ab") as file:
            file.write(bytes(2**20))
            _flush(partial)
    except OSError as cause:
        return OSError(cause.errno, cause.strerror, os.fspath(path))
    return None


def _flush(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
