"""Let a process of its own, with limits, read a netCDF file of unknown origin first.

Bytes that were made for it can keep the HDF5 library busy for ever (measured: 3 of 15,000 spoilt files with a valid
seal), and older versions were crashed by some. The child imports nothing but the netCDF library.
"""

import subprocess
import sys
from os import PathLike, fspath

from surrogate.sealed import FormatError

SECONDS = 10
MEMORY = 4 * 2**30

CHILD = f"""
import resource, sys, netCDF4
resource.setrlimit(resource.RLIMIT_CPU, ({SECONDS}, {SECONDS}))
resource.setrlimit(resource.RLIMIT_AS, ({MEMORY}, {MEMORY}))
with netCDF4.Dataset(sys.argv[1], "r") as file:
    for variable in file.variables.values():
        if variable.size < {MEMORY // 64}:
            variable[...]
"""


def try_to_read(path: str | PathLike[str]) -> None:
    """Let a child read the file; what it finds does not matter, only that it comes to an end.

    Raises
    ------
    FormatError
        The file keeps the library busy, or crashes it.
    """
    command = [sys.executable, "-I", "-c", CHILD, fspath(path)]
    try:
        done = subprocess.run(command, capture_output=True, timeout=5 * SECONDS, check=False)
    except subprocess.TimeoutExpired:
        raise FormatError(path, "no readable netCDF-4 file (it keeps the library busy)") from None
    if done.returncode < 0:
        raise FormatError(path, f"no readable netCDF-4 file (it ends the library by signal {-done.returncode})")
