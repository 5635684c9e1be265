"""The rooms where digits matter under every OpenBLAS kernel of this processor.

`python -m tests.kernels` takes a few files on one thread, `python -m tests.kernels soak` whole rooms on one thread and
on two. It ends with one line on the kernels that were not run.
"""

import os
import subprocess
import sys
from typing import Any

#: Values of OPENBLAS_CORETYPE; the last one runs on every processor.
KERNELS = ("Haswell", "SkylakeX", "Zen", "Nehalem")
QUICK = [
    "tests/workflow/design/test_polish.py",
    "tests/workflow/study/test_categories.py",
    "tests/surrogate/search/test_optimise.py",
    "tests/test_examples.py",
]
ALL = ["tests/surrogate", "tests/workflow/design", "tests/workflow/study", "tests/test_examples.py"]
_PROBE = """
import numpy
from threadpoolctl import threadpool_info
numpy.linalg.cholesky(numpy.eye(64) @ numpy.eye(64))
print(next(library["architecture"] for library in threadpool_info() if library["internal_api"] == "openblas"))
"""


def _python(words: list[str], kernel: str, threads: int = 1, **options: Any) -> subprocess.CompletedProcess[Any]:
    variables = {**os.environ, "OPENBLAS_CORETYPE": kernel, "OMP_NUM_THREADS": str(threads)}
    return subprocess.run([sys.executable, *words], env=variables, check=False, **options)


def distinct() -> list[str]:
    """Return the kernels that differ on this processor."""
    kernels: dict[str, str] = {}
    for kernel in KERNELS:
        probe = _python(["-c", _PROBE], kernel, capture_output=True, text=True)
        if probe.returncode == 0 and probe.stdout.strip():
            kernels.setdefault(probe.stdout.strip(), kernel)
    return list(kernels.values())


def main(soak: bool) -> int:
    """Run the rooms under each kernel that differs here; return the number of runs that failed."""
    kernels, failed = distinct(), 0
    for kernel, threads in ((kernel, threads) for kernel in kernels for threads in range(1, 2 + soak)):
        print(f"{kernel}, threads: {threads}", flush=True)
        workers = str(max((os.cpu_count() or 1) // threads, 1))
        files = ["-m", "not slurm", *ALL] if soak else QUICK
        failed += _python(["-m", "pytest", "-n", workers, *files], kernel, threads).returncode != 0
    print(f"kernels not run: {', '.join(sorted({*KERNELS} - {*kernels})) or 'none'}")
    return failed


if __name__ == "__main__":
    sys.exit(main("soak" in sys.argv[1:]))
