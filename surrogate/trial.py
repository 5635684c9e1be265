"""Let a process of its own, with limits, read a netCDF file of unknown origin first.

Bytes that were made for it can keep the HDF5 library busy for ever (measured: 3 of 15,000 spoilt files with a valid
seal) or make it take gigabytes, and older versions were crashed by some. The child imports nothing but the netCDF
library.
"""

import os
import subprocess
import sys
from os import PathLike, fspath
from pathlib import Path

from surrogate.sealed import FormatError, check_seal

SECONDS = 10
MEMORY = 3 * 2**29  # of addresses; a third is the library's

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
    """Let a child read the file; what it finds does not matter, only that it comes to an end within the limits.

    Raises
    ------
    FormatError
        The file keeps the library busy, crashes it, asks it for too much memory or is none that it reads.
    """
    command = [sys.executable, "-I", "-c", CHILD, fspath(path)]
    try:
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}  # each thread would reserve addresses
        done = subprocess.run(command, capture_output=True, timeout=5 * SECONDS, check=False, env=environment)
    except subprocess.TimeoutExpired:
        raise FormatError(path, "no readable netCDF-4 file (it keeps the library busy)") from None
    if done.returncode < 0:
        raise FormatError(path, f"no readable netCDF-4 file (it ends the library by signal {-done.returncode})")
    if done.returncode:
        check_seal(Path(path), MEMORY)  # says it better where the file is not whole
        raise FormatError(path, "no readable netCDF-4 file (the library cannot read it within its limits)")
