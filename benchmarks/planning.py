"""Ten planned measurements beside ten at random, on the synthetic devices of `benchmarks.learning`.

Each device has two or ten measured rows, known errors of 1 %, and discrepancies of 0.3 %; the posterior is that of the
model linearised at its nominal constants. Told are the width after random over that after planned measurements, and
over that after all 200 places: no plan of ten can do better than that.

``python -m benchmarks.planning [DEVICES]``
"""

import sys
from dataclasses import replace

import numpy as np

from approximation.arrays import Array, Indices
from benchmarks.learning import ERROR, FAMILY, FIRST, INPUTS, OWN, SIZES, Device, Scenario, slopes
from surrogate.data.inputs import physical_points, unit_coordinates
from surrogate.transforms.measured.draws import Draw
from surrogate.use.planning import chosen, joint, spread, widths
from surrogate.use.residuals import Residuals

FURTHER, CANDIDATES, RANDOM = 10, 200, 5
#: Prior deviations of three families, and of each constant beside its family.
PRIOR = np.where(np.arange(12) < 3, 1.0, 0.5)
#: Derivatives of the nine constants by these.
SINGLE = np.column_stack([FAMILY * np.repeat(np.eye(3), 3, 0), OWN * np.eye(9)])
#: What plans are for.
WANTED = {
    "first family": [0], "second family": [1], "third family": [2], "all families": [0, 1, 2],
    "constant known least": [], "answer known least": [],
}  # fmt: skip


class Planned:
    """One device after its first rows: its posterior over constants, single ones, answers and readings."""

    def __init__(self, seed: int, rows: int, outputs: Indices) -> None:
        device = Device(Scenario(), seed, rows=rows, fresh=1)
        read, measured = device.read()[0], device.points[:rows]
        t, by, processes = unit_coordinates(INPUTS, measured).T, slopes(measured, np.zeros(12)), {}
        for q in range(2):
            k = read.of(q)
            if not len(k):
                continue  # what was never measured has no discrepancy
            at, zero = read.row[k], np.zeros(len(k))
            some = Residuals.of(t[at], read.value[k], by[at, q], read.error[k], zero, zero + SIZES[q])
            processes[q] = some.at(replace(some.first, scale=0.0, amplitude=float(np.log(0.003))))
        draw = Draw.of(processes, PRIOR)
        asked = np.random.default_rng((seed, 6)).uniform(-1, 1, (4, 2))  # a place for every output's answer
        places, each = np.concatenate([spread(2, CANDIDATES), asked]), len(outputs)
        points = physical_points(INPUTS, places.T)
        where = np.concatenate([np.repeat(np.arange(CANDIDATES), each), CANDIDATES + np.arange(4)])
        output = np.concatenate([np.tile(outputs, CANDIDATES), np.arange(4)])
        both = joint(draw, places[where], output, slopes(points, np.zeros(12))[where, output])
        singles = np.eye(12 + len(where))
        singles = np.concatenate([singles[:12], np.pad(SINGLE, ((0, 0), (0, len(where)))), singles[12:]])
        self.joints, self.readings = [singles @ both @ singles.T], len(where) - 4
        self.noise = np.append((ERROR * SIZES[output[:-4]]) ** 2, [np.inf] * 4)
        even = np.arange(each * (CANDIDATES // 2), self.readings)
        random = np.random.default_rng(seed)
        self.random = [random.choice(even, FURTHER, replace=False).tolist() for _ in range(RANDOM)]
        self.priors = np.concatenate([PRIOR, np.linalg.norm(SINGLE * PRIOR, axis=1)])

    def wanted(self, name: str) -> Indices:
        """Numbers of what a plan is for."""
        now = np.sqrt(np.diag(self.joints[0]))
        if name == "constant known least":
            return np.array([12 + np.argmax(now[12:21] / self.priors[12:])])
        if name == "answer known least":
            return np.array([len(now) - 4 + np.argmax(now[-4:] / SIZES)])
        return np.array(WANTED[name], np.intp)

    def ratios(self, name: str) -> tuple[float, float]:
        """Width after random over that after planned measurements, and after all; geometric mean of several."""
        wanted = self.wanted(name)
        plan = chosen(self.joints, self.noise, wanted, FURTHER)
        planned, every, *others = (
            np.log(widths(self.joints, self.noise, taken, wanted))
            for taken in (plan, list(range(self.readings)), *self.random)
        )
        other = np.median(others, axis=0)
        return float(np.exp(np.mean(other - planned))), float(np.exp(np.mean(other - every)))


def measure(devices: int = 200) -> dict[str, Array]:
    """Both ratios of every device (devices, 2), by rows, outputs that can be measured, and what is wanted."""
    measured = {}
    for rows in (2, 10):
        for outputs in ([0, 1], [0, 1, 2, 3]):
            every = [Planned(FIRST + k, rows, np.array(outputs, np.intp)) for k in range(devices)]
            for name in WANTED:
                ratios = np.array([device.ratios(name) for device in every])
                measured[f"{rows} rows, {len(outputs)} outputs, {name}"] = ratios
                low, middle, high = np.quantile(ratios[:, 0], [0.05, 0.5, 0.95])
                print(
                    f"  {rows} rows, {len(outputs)} outputs, {name}: median {middle:.2f} ({low:.2f} to {high:.2f}), "
                    f"all places {np.median(ratios[:, 1]):.2f}",
                    flush=True,
                )
    return measured


if __name__ == "__main__":
    measure(*[int(word) for word in sys.argv[1:2]])
