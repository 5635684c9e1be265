"""An exported surrogate as a compiled library, asked through ctypes."""

import ctypes
import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from approximation.arrays import Array, Indices
from tests import programs

STRICT = ("-std=c89", "-Wall", "-Wextra", "-pedantic", "-Werror")


class Compiled:
    """The functions of NAME.c, with NAME.h beside it."""

    def __init__(self, source: Path, *flags: str) -> None:
        name, library = source.stem, source.with_suffix(".".join(["", *(flag.strip("-") for flag in flags), "so"]))
        macro = f"-D{name.upper()}_SELFTEST"
        gcc, code = programs.path("gcc"), str(library.with_suffix(".o"))
        subprocess.run([gcc, *STRICT, *flags, macro, "-fPIC", "-c", str(source), "-o", code], check=True)
        # linked without -ffast-math, whose start-up code flushes denormals to zero in the whole test process
        subprocess.run([gcc, "-shared", code, "-lm", "-o", str(library)], check=True)
        header = source.with_suffix(".h").read_text(encoding="ascii")
        real = ctypes.c_float if f"typedef float {name}_real" in header else ctypes.c_double
        self._dtype = np.dtype(real)
        self.constants = {key: int(value) for key, value in re.findall(rf"#define {name.upper()}_(\w+) (\d+)", header)}
        self._inputs, self._outputs = self.constants["INPUTS"], self.constants["OUTPUTS"]
        loaded, pointer = ctypes.CDLL(str(library)), ctypes.POINTER(real)
        self._code = {part: getattr(loaded, f"{name}_{part}") for part in ("inside", "value", "interval", "gradient")}
        self.selftest = getattr(loaded, f"{name}_selftest")
        self._pointer = pointer

    def asked(self, part: str, X: Array, output: int = 0) -> tuple[Indices, Array]:
        """Status (n,) and answers (n, m) at points (n, d); NaN where nothing was written."""
        size = {"inside": 0, "value": 1, "interval": 3, "gradient": self._inputs}[part]
        points = np.ascontiguousarray(X, dtype=self._dtype)
        answers = np.full((len(X), max(size, 1)), np.nan, dtype=self._dtype)
        status = np.empty(len(X), dtype=np.intp)
        function = self._code[part]
        for row in range(len(X)):
            x = points[row].ctypes.data_as(self._pointer)
            ends = self._places(answers[row], part)
            status[row] = function(x) if part == "inside" else function(output, x, *ends)
        return status, answers[:, :size].astype(np.float64)

    def _places(self, row: Array, part: str) -> Sequence[object]:
        count = 1 if part == "gradient" else len(row)
        return [row[k:].ctypes.data_as(self._pointer) for k in range(count)]
