"""Plain files that appear whole or not at all, and checks of files before they are read or replaced."""

import errno
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from storage.sealed import appearing


def regular(path: Path) -> Path:
    """Return the path, or raise OSError for a device, which never ends, or a pipe, which makes its reader wait."""
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):  # a folder says so itself when it is opened
        raise OSError(errno.EINVAL, "not a regular file", str(path))
    return path


def output(path: Path, *inputs: Path) -> Path:
    """Return the output file that an option names, or a link's target; OSError if it must not be replaced."""
    target = path.resolve() if path.is_symlink() else path
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: the folder {target.parent} does not exist")
    if target.exists():
        if not target.is_file():
            raise OSError(errno.EINVAL, "not a regular file, so it is not replaced", str(path))
        for file in inputs:
            if file.exists() and target.samefile(file):
                raise OSError(errno.EINVAL, "is an input of this command, so it is not replaced", str(path))
    return target


def write_text(path: Path, text: str) -> None:
    """Write a text in UTF-8, whole or not at all."""
    write_bytes(path, text.encode())


def write_bytes(path: Path, content: bytes) -> None:
    """Write bytes, whole or not at all."""
    with writing(path) as file:
        file.write(content)


@contextmanager
def writing(path: Path) -> Iterator[BinaryIO]:
    """Yield a temporary file that takes its final name in the end, or is removed after an error."""
    with appearing(path) as partial, partial.open("xb") as file:
        yield file
