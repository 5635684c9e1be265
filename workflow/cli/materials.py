"""What ``meecontact material`` says of the built-in materials."""

import numpy as np

from solver import Material, materials


def listed() -> str:
    """A line for every built-in material: name, a mark where its constants are in doubt, coupling, source."""
    known = materials()
    width = max(map(len, known))
    lines = [
        f"{name:{width}s} {'*' if one.note else ' '} {_kind(one):23s}  {one.source}" for name, one in known.items()
    ]
    lines.append("* repaired, doubtful or disputed: meecontact material NAME says what, with the constants and roots")
    lines.append("own materials: meecontact material FILE.yaml")
    return "\n".join(lines)


def _kind(material: Material) -> str:
    electric, magnetic = (
        any(np.any(getattr(material, f"{letter}{axes}")) for axes in ("31", "33", "15")) for letter in "ef"
    )
    if electric and magnetic:
        return "magneto-electro-elastic"
    return "piezoelectric" if electric else "piezomagnetic" if magnetic else "elastic"
