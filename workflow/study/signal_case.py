"""The contact that a press in time names beside those of its study, and its surroundings, device and materials."""

from typing import TypeVar

from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.materials import material_of
from workflow.study import defaults
from workflow.study.contents import Contents
from workflow.study.reading import located

Whole = TypeVar("Whole", bound=Contents)


def of(study: Whole) -> Whole:
    """The study of that contact alone: all of its factors are fixed, and it has the defaults of a study."""
    assert study.signal is not None
    bare = {name: key.get_default(call_default_factory=True) for name, key in type(study).model_fields.items()}
    contact = study.model_copy(
        update=bare
        | {
            "title": study.signal.title,
            "phases": study.phases,
            "fixed": dict(study.signal.case),
            "device": study.signal.device or study.device,
        }
    )
    defaults.settle(contact)
    return contact


def check(study: Contents) -> None:
    """Raise ValueError, in one line, unless the factors are those of a contact that an amplifier may read."""
    assert study.signal is not None
    contact = of(study)
    with located("signal: case"):
        force = contact.kind.loads.force
        material_of(Cases(checked({force: study.signal.force, **contact.fixed}), contact.own_materials, study.phases))
    kind = contact.kind
    if kind.datum == "relative" or "charge_per_force" not in kind.quantities:
        raise ValueError("signal: case: a film, or a point contact, has a charge to be read; this has none")
    for name in (force, *kind.loads.charges):
        if name in contact.fixed:
            raise ValueError(f"signal: case: {name}: the press gives the force, and the circuit the charge")
    if contact.device is None or contact.device.amplifier is None:
        raise ValueError("signal: needs device: amplifier")
    with located("signal: device"):
        contact.device.check(kind.contact)
