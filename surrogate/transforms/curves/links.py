"""Rows of the smooth outputs behind each output of a `CurveGP`, and the scaling by them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from approximation.arrays import Array
from approximation.measure import Measure
from surrogate.data.packing import Rounded
from surrogate.transforms.curves.basis import Basis, Curves, Largest

# Rounding of fields of curves, in their sizes: what follows from them is still the same to 1e-9.
STEP = 1e-12


def learnt_name(size: str, logarithms: bool) -> str:
    """Return the name of the smooth output that tells a size."""
    return f"log {size}" if logarithms else size


class Links:
    """Rows of smooth outputs behind p outputs.

    plain: Outputs that are smooth themselves, and their rows.
    sizes: Rows of the sizes.
    scores: Rows of the scores of every element of `curves`.
    """

    def __init__(
        self,
        outputs: Sequence[str],
        largest: Mapping[str, Largest],
        curves: Sequence[Curves],
        bases: Sequence[Basis],
        logarithms: bool,
        smooth: Sequence[str],
    ) -> None:
        self._outputs, self._largest, self._curves, self._bases = outputs, largest, curves, bases
        self._logarithms, self._smooth = logarithms, smooth
        rows = {name: k for k, name in enumerate(smooth)}
        self.plain = [(k, rows[name]) for k, name in enumerate(outputs) if name not in largest]
        sizes = sorted({size for curve in curves for size in curve.sizes if size})
        self.sizes = {size: rows[name] for size in sizes if (name := learnt_name(size, logarithms)) in rows}
        self.scores = [
            [rows[name] for k in range(len(basis.vectors)) if (name := f"score {number} {k}") in rows]
            for number, basis in enumerate(bases)
        ]

    def searches(self) -> Iterator[tuple[int, Measure, list[str]]]:
        """Numbers of curves, measures of them, and the outputs that each of these gives."""
        searched = {(largest.curves, largest.measure): None for largest in self._largest.values()}
        for number, measure in sorted(searched, key=lambda search: search[0]):
            key = number, measure
            names = [name for name, largest in self._largest.items() if (largest.curves, largest.measure) == key]
            yield number, measure, names

    def size_of(self, name: str) -> str:
        """Return the name of the size that an output scales by, empty where there is none."""
        largest = self._largest[name]
        return self._curves[largest.curves].sizes[max(largest.place, 0)]

    def size(self, name: str, smooth: Array) -> Array:
        """Return what an output scales by.

        smooth: (q, B); result: (B,).
        """
        size = self.size_of(name)
        if not size:
            return np.ones(smooth.shape[1])
        learnt = smooth[self.sizes[size]]
        return np.asarray(np.exp(learnt) if self._logarithms else learnt)

    def spread(self, smooth: Array) -> Array:
        """Return every output's standard deviation over that of its witness, from smooth outputs (q, B): (p, B)."""
        out = np.ones((len(self._outputs), smooth.shape[1]))
        for k, name in enumerate(self._outputs):
            if name in self._largest:
                out[k] = self._typical(name) * self.size(name, smooth)
        return out

    def _typical(self, name: str) -> float:
        """The same where the output's size is one."""
        if name not in self._largest:
            return 1.0
        largest = self._largest[name]
        basis = self._bases[largest.curves]
        typical = 1 / np.sqrt(basis.mean.size)  # of a score's vector, over the scale of its field
        return float(typical * (basis.scales[0] if largest.place < 0 else np.ptp(basis.mean[largest.place])))

    def behind(self, outputs: Sequence[str]) -> list[str]:
        """Return the smooth outputs that some outputs need: plain ones, sizes, scores."""
        largest = [name for name in outputs if name in self._largest]
        sizes = sorted({self.size_of(name) for name in largest} - {""})
        used = sorted({self._largest[name].curves for name in largest})
        names = [name for name in outputs if name not in self._largest]
        names += [learnt_name(size, self._logarithms) for size in sizes]
        return names + [self._smooth[row] for number in used for row in self.scores[number]]

    def described(self, spreads: Array) -> dict[str, Any]:
        """Return links, measures and curves as plain values.

        spreads: (q,).
        """
        measures = list(dict.fromkeys(largest.measure for largest in self._largest.values()))
        return {
            "plain": self.plain,
            "largest": [
                {
                    "output": list(self._outputs).index(name),
                    "net": largest.curves,
                    "measure": measures.index(largest.measure),
                    "place": largest.place,
                    "size": self.sizes[size] if (size := self.size_of(name)) else -1,
                }
                for name, largest in self._largest.items()
            ],
            "measures": [{"linear": measure.linear.tolist(), "root": measure.root.tolist()} for measure in measures],
            "logarithms": self._logarithms,
            "nets": [
                {
                    "across": curve.panels.across,
                    "down": curve.panels.down,
                    "scores": rows,
                    "whole": _whole(basis, spreads[rows]),
                }
                for curve, basis, rows in zip(self._curves, self._bases, self.scores, strict=True)
            ],
            "spread": [self._typical(name) for name in self._outputs],
        }


def _whole(basis: Basis, spreads: Array) -> Rounded:
    """Mean and vectors of curves, (1 + rank, point, field); ``spreads`` are the sizes of their scores."""
    whole = np.concatenate([basis.mean[None], basis.vectors]).swapaxes(1, 2)
    return Rounded(whole, 1 / np.concatenate([[1.0], spreads]), STEP * basis.scales)
