"""A model as plain data, for evaluation elsewhere, such as in a browser."""

from typing import Any

from surrogate.data.packing import encoded
from surrogate.face.model import GaussianProcess

FORMAT = 4


def exported(model: GaussianProcess) -> dict[str, Any] | None:
    """Return everything that mean, standard deviation and interval need, as what JSON can hold.

    Arrays are ``{"shape": [...], "data": base64 of little-endian float64}``, so that no digit is lost; cores are as
    :func:`surrogate.data.packing.encoded` has them, which changes a mean by some 1e-10 of a standard deviation.
    """
    plain = model.plain()
    if plain is None:
        return None
    region = {} if model.region_ is None else {"region": model.region_.plain()}
    return {"format": FORMAT, **encoded({**plain, **region})}
