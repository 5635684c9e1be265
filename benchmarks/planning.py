"""Ten planned measurements beside ten at random, on the synthetic devices of `benchmarks.learning`.

Each device has ten measured rows, known errors of 1 %, and discrepancies of 0.3 %; the posterior is that of the model
linearised at its nominal constants. Ratio of the widths after random and after planned measurements.

``python -m benchmarks.planning [DEVICES]``
"""

import sys
from dataclasses import replace

import numpy as np

from approximation.arrays import Indices
from benchmarks.learning import ERROR, FIRST, INPUTS, SIZES, Device, Scenario, slopes
from benchmarks.rivals import Array
from surrogate.data.inputs import unit_coordinates
from surrogate.transforms.measured.draws import Draw
from surrogate.use.planning import chosen, joint, widths
from surrogate.use.residuals import Residuals

ROWS, FURTHER, CANDIDATES = 10, 10, 200
#: Constants that plans are for.
WANTED = {"first family": [0], "second family": [1], "third family": [2], "all families": [0, 1, 2]}


def ratio(seed: int, wanted: Indices, outputs: Indices) -> float:
    """Width after random over that after planned measurements, of several constants the geometric mean."""
    device = Device(Scenario(), seed, rows=ROWS, fresh=CANDIDATES)
    rows, t = device.read()[0], unit_coordinates(INPUTS, device.points).T
    by, processes = slopes(device.points, np.zeros(12)), {}
    for q in range(2):
        k = rows.of(q)
        at, zero = rows.row[k], np.zeros(len(k))
        some = Residuals.of(t[at], rows.value[k], by[at, q], rows.error[k], zero, zero + SIZES[q])
        processes[q] = some.at(replace(some.first, scale=0.0, amplitude=float(np.log(0.003))))
    draw = Draw.of(processes, np.where(np.arange(12) < 3, 1.0, 0.5))
    where = ROWS + np.repeat(np.arange(CANDIDATES), len(outputs))
    output = np.tile(outputs, CANDIDATES)
    both, noise = [joint(draw, t[where], output, by[where, output])], (ERROR * SIZES[output]) ** 2
    random = np.random.default_rng(seed).choice(len(noise), FURTHER, replace=False)
    plan = chosen(both, noise, wanted, FURTHER)
    planned, other = (widths(both, noise, one, 12)[wanted] for one in (plan, random.tolist()))
    return float(np.exp(np.mean(np.log(other / planned))))


def measure(devices: int = 200) -> dict[str, Array]:
    """Ratios of every device, by what is wanted and what can be measured."""
    found = {}
    for what, outputs in {"two measured outputs": [0, 1], "all four outputs": [0, 1, 2, 3]}.items():
        for name, wanted in WANTED.items():
            every = [ratio(FIRST + k, np.array(wanted, np.intp), np.array(outputs, np.intp)) for k in range(devices)]
            found[f"{what}, {name}"] = np.array(every)
            low, middle, high = np.quantile(every, [0.05, 0.5, 0.95])
            print(f"  {what}, {name}: median {middle:.2f} ({low:.2f} to {high:.2f})", flush=True)
    return found


if __name__ == "__main__":
    measure(*[int(word) for word in sys.argv[1:2]])
