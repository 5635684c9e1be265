"""Cross approximation: tensors of known rank from few entries, steps that need no state, rows that interpolate."""

import numpy as np

from approximation.arrays import Array
from surrogate.gp.crossgp import Cross, Crossed, run

SIZES = (7, 6, 5, 4)
BLOCK, OUTPUTS = 9, 2
Known = dict[tuple[int, ...], Array]


def separable(rank: int) -> Array:
    """A sum of so many products of random functions of the indices and of the block: (*SIZES, BLOCK, OUTPUTS)."""
    random = np.random.default_rng(rank)
    parts = [random.normal(size=(size, rank)) for size in (*SIZES, BLOCK, OUTPUTS)]
    return np.asarray(np.einsum("ar,br,cr,dr,er,fr->abcdef", *parts))


def found(tensor: Array, cross: Cross, known: Known, batches: list[list[list[int]]] | None = None) -> Crossed:
    while not isinstance(wanted := run(cross.steps(), known), Crossed):
        if batches is not None:
            batches.append(wanted.tolist())
        known |= {tuple(index): tensor[tuple(index)] for index in wanted.tolist()}
    return wanted


def test_an_interrupted_approximation_goes_on_with_the_same_batches_to_the_same_bits() -> None:
    tensor, cross = separable(4), Cross(SIZES, 1e-8)
    batches: list[list[list[int]]] = []
    whole = found(tensor, cross, Known(), batches)
    half: Known = {tuple(i): tensor[tuple(i)] for batch in batches[:3] for i in batch}
    half |= {tuple(i): tensor[tuple(i)] for i in batches[3][: len(batches[3]) // 2]}
    remaining: list[list[list[int]]] = []
    again = found(tensor, cross, half, remaining)
    assert remaining == [batches[3][len(batches[3]) // 2 :], *batches[4:]]
    for first, other in zip(whole.cores, again.cores, strict=True):
        assert first.tobytes() == other.tobytes()


def test_no_batch_repeats_an_entry_and_the_most_ends_the_sweeps() -> None:
    tensor, batches = np.random.default_rng(0).normal(size=(*SIZES, 1, OUTPUTS)), list[list[list[int]]]()
    got = found(tensor, Cross(SIZES, 1e-3, most=30), Known(), batches)
    entries = [tuple(index) for batch in batches for index in batch]
    assert len(set(entries)) == len(entries) == got.entries > 30
    assert len(batches) <= 1 + len(SIZES)
    assert got.error.max() > 1e-3
