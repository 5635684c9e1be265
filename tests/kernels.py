"""The rooms where digits matter under every kernel of OpenBLAS that this processor runs.

``python -m tests.kernels`` takes a few files, each kernel on one thread; ``python -m tests.kernels soak`` takes whole
rooms, on one thread and on two. It ends with one line on the kernels that were not run.
"""

import os
import subprocess
import sys
from collections.abc import Sequence
from itertools import product
from typing import Any

#: Values of OPENBLAS_CORETYPE; the last one runs on every processor.
KERNELS = ("Haswell", "SkylakeX", "Zen", "Nehalem")
QUICK = (
    "tests/workflow/design/test_polish.py",
    "tests/workflow/study/test_categories.py",
    "tests/surrogate/search/test_optimise.py",
    "tests/test_examples.py",
)
ALL = ("tests/surrogate", "tests/workflow/design", "tests/workflow/study", "tests/test_examples.py")
_PROBE = """
import numpy
from threadpoolctl import threadpool_info
numpy.linalg.cholesky(numpy.eye(64) @ numpy.eye(64))
print(next(library["architecture"] for library in threadpool_info() if library["internal_api"] == "openblas"))
"""


def distinct() -> tuple[list[str], list[str]]:
    """Return the kernels that differ on this processor, and those that are left out."""
    kernels: dict[str, str] = {}
    for kernel in KERNELS:
        probe = _python(["-c", _PROBE], kernel, capture_output=True, text=True)
        if probe.returncode == 0 and probe.stdout.strip():
            kernels.setdefault(probe.stdout.strip(), kernel)
    return list(kernels.values()), [kernel for kernel in KERNELS if kernel not in kernels.values()]


def _python(words: Sequence[str], kernel: str, threads: int = 1, **options: Any) -> subprocess.CompletedProcess[Any]:
    variables = {**os.environ, "OPENBLAS_CORETYPE": kernel, "OMP_NUM_THREADS": str(threads)}
    return subprocess.run([sys.executable, *words], env=variables, check=False, **options)


def main(words: Sequence[str]) -> int:
    """Run the rooms under each kernel that differs here; return the number of runs that failed."""
    soak, failed = "soak" in words, 0
    kernels, left_out = distinct()
    for kernel, threads in product(kernels, (1, 2) if soak else (1,)):
        print(f"{kernel}, threads: {threads}", flush=True)
        workers = str(max((os.cpu_count() or 1) // threads, 1))
        files = ["-m", "not slurm", *ALL] if soak else QUICK
        failed += _python(["-m", "pytest", "-n", workers, *files], kernel, threads).returncode != 0
    print(f"kernels not run: {', '.join(left_out) or 'none'}")
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
