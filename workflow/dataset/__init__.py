"""Exact cases of a study on disk: levels, slabs, quantities, effects and the card that describes them."""
