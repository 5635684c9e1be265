"""Electric and magnetic fields that a study's cases feel, and the quantities and materials of these cases."""

from collections.abc import Mapping, Sequence

import numpy as np

from solver import Material, find
from solver.fields import Field, fields_of
from solver.material.composite import compose
from solver.names import ALL_QUANTITIES, CHOICES, MIXTURES
from solver.stack.layers import RIGID
from workflow.study.categories import output
from workflow.study.contents import Contents

#: Constants by which a material couples a field to its deformation, or to the other field.
_COUPLING: dict[Field, tuple[str, ...]] = {
    "electric": ("e31", "e33", "e15", "g11", "g33"),
    "magnetic": ("f31", "f33", "f15", "g11", "g33"),
}


def fields(study: Contents) -> frozenset[Field]:
    """Return the fields to which some material in use couples, or of which a punch has a charge."""
    coupled = {
        field
        for material in materials(study)
        for field, constants in _COUPLING.items()
        if any(np.any(np.nan_to_num(getattr(material, name))) for name in constants)
    }
    values = _named_values(study)
    for field, charge in zip(_COUPLING, study.kind.loads.charges, strict=True):
        if charge in study.factors or any(value not in (0.0, None) for value in values.get(charge, [])):
            coupled.add(field)
    return frozenset(coupled)


def felt_outputs(study: Contents) -> list[str]:
    """Return the learned quantities among `felt_quantities`."""
    names = felt_quantities(study)
    return [name for name in study.outputs if name in names]


def felt_quantities(study: Contents) -> frozenset[str]:
    """Return the quantities that measure no other field than the study's, and those that the study names."""
    named = set(wanted(study) if study.design else ()) | set(study.surrogate.outputs)
    named |= {name for readout in study.readout.values() for name in readout.measured}
    coupled = fields(study)
    return frozenset(
        name for name, quantity in ALL_QUANTITIES.items() if name in named or fields_of(quantity.units) <= coupled
    )


def outputs(study: Contents) -> list[str]:
    """Return `felt_outputs` by their names in the surrogate, for every combination of the categories."""
    names = felt_outputs(study)
    return [output(name, combination) for combination in study.combinations for name in names]


def wanted(study: Contents) -> list[str]:
    """Return the learned quantities in the designs, or else all learned quantities."""
    return _asked(study) or study.outputs


def _asked(study: Contents) -> list[str]:
    names = (name for target in study.design.values() for name in target.names())
    return [name for name in dict.fromkeys(names) if name in study.outputs]


def of_interest(study: Contents) -> list[str]:
    """Return `wanted` by the names in the surrogate, for every combination of the categories."""
    return [
        output(name, combination) for name in _asked(study) for combination in study.combinations
    ] or study.output_names


def aims(study: Contents) -> list[str]:
    """Return the quantities in the designs' goals by their names in the surrogate, or else its first two outputs."""
    goals = [goal.expression for target in study.design.values() for goal in target.objectives]
    names = dict.fromkeys(name for goal in goals for name in goal.names())
    outputs = [name for name in names if name in study.outputs] or study.outputs[:2]
    return [output(name, combination) for name in outputs for combination in study.combinations]


def materials(study: Contents) -> list[Material]:
    """Return the materials of a study's cases, each once; of an alloy the one without the added element."""
    values = _named_values(study)
    names = [*values.get("material", []), *(layer.material for layer in study.body)]
    kinds = composites(study)
    phases = study.phases if any(kind in MIXTURES for kind in kinds) else []
    known = dict.fromkeys([*names, *values.get("base", []), *phases])
    alloys = [compose(kind, (), 0.0) for kind in kinds if kind not in MIXTURES]
    return [*(find(str(name), study.own_materials) for name in known if name and name != RIGID), *alloys]


def composites(study: Contents) -> list[str]:
    """Return the names of composites and alloys of a study's cases, the default included."""
    names = [*_named_values(study).get("composite", []), *(layer.composite for layer in study.body if layer.composite)]
    baseline = study.effects.baseline if study.effects else {}
    if not names and not study.body and "material" not in {**study.fixed, **study.categories, **baseline}:
        names = [CHOICES["composite"][0]]
    return list(dict.fromkeys(map(str, names)))


def _named_values(study: Contents) -> dict[str, list[float | str]]:
    """Return the names and numbers of each factor or category, without the ranges of a factorial."""
    values: dict[str, list[float | str]] = {}
    parts: list[Mapping[str, float | str | Sequence[float | str]]] = [study.fixed, study.categories]
    if study.effects:
        parts += [study.effects.baseline, study.effects.film, study.effects.vary]
    for name, value in (pair for part in parts for pair in part.items()):
        values.setdefault(name, []).extend([value] if isinstance(value, str | float | int) else value)
    return values
