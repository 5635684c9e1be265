"""Checks that outputs, targets and read-outs of a study are among the quantities of its cases."""

from collections.abc import Sequence

from solver.names import ALL_PEAKS, ALL_QUANTITIES, EVERY_FILM_QUANTITY, HEAT_QUANTITIES, OF_A_FILM
from workflow.language.constants import CONSTANTS
from workflow.language.factors import FACTORS
from workflow.study.contents import Contents
from workflow.study.reading import located
from workflow.study.sections import Readout
from workflow.study.target import Target

_OF_FILMS = {*OF_A_FILM, *EVERY_FILM_QUANTITY}
_SMOOTH = {"profile": "cylinder", "electric": "conducting", "magnetic": "conducting"}


def check_quantities(study: Contents) -> None:
    """Raise ValueError unless the data set holds every quantity of the surrogate and the designs."""
    for name in study.searched if isinstance(study.dataset.peaks, list) else ():
        if name in study.absent or name not in ALL_PEAKS:
            known = ", ".join(name for name in ALL_PEAKS if name not in study.absent)
            raise ValueError(f"dataset: peaks: these cases have no {name!r}; they have {known}")
    for name in study.surrogate.outputs:
        if name in study.absent or ALL_QUANTITIES[name].sparse:
            raise ValueError(f"surrogate: outputs: some of these cases have no {name!r}{_instead(study, name)}")
        if name in ALL_PEAKS.keys() - study.searched:
            raise ValueError(f"surrogate: outputs: {name!r} needs dataset: peaks: true")
    for name in study.surrogate.log or []:
        if not study.groups or name not in study.outputs:
            needs = "is not one of surrogate.outputs" if study.groups else "needs groups"
            raise ValueError(f"surrogate: log: {name!r} {needs}")
    if study.surrogate.fields and study.kind.tabled:
        raise ValueError("surrogate: fields: only those of half-planes are learned")
    if study.surrogate.fields and any(study.fixed.get(name, usual) != usual for name, usual in _SMOOTH.items()):
        raise ValueError("surrogate: fields: only those under a cylinder that conducts in both fields are learned")
    if study.surrogate.fields and study.categories:
        raise ValueError(f"surrogate: fields: are not learned over categories: {', '.join(study.categories)}")
    for label, target in study.design.items():
        with located(f"design: {label}"):
            check_target(study, target)
    if study.signal is not None and not study.signal.study:
        check_pressed(study, study.signal.design)
    elif study.signal is not None and study.signal.design in study.design:
        raise ValueError(f"signal: design: {study.signal.design!r} is a name of this study's designs, too; rename one")
    for label, readout in study.readout.items():
        with located(f"readout: {label}"):
            _check_readout(study, readout)


def check_pressed(study: Contents, design: str) -> None:
    """Raise ValueError unless the punch of a design can be read."""
    if design not in study.design:
        known = ", ".join(study.design) or "none"
        raise ValueError(f"signal: design: {design!r} is not a design target; known are {known}")
    if study.device is None or study.device.amplifier is None:
        raise ValueError("signal: needs device: amplifier")
    target = study.design[design]
    for name in study.kind.loads.charges:
        if name in (*target.over, *target.at, *target.worst_case, *target.uncertain, *study.fixed):
            raise ValueError(f"signal: {name}: the circuit gives the charge; the design must not")
    collected = "collector" in study.fixed or "collector" in study.factors
    needed = ("patch_charge_per_force",) if collected else ("charge_per_force", "voltage")
    for name in needed:
        if name in study.absent:
            raise ValueError(f"signal: these cases have no {name}, whose charge would be read")


def _check_readout(study: Contents, readout: Readout) -> None:
    """Raise ValueError unless a read-out holds or infers every factor, and measures learned quantities."""
    for name in study.factors:
        if (name in readout.infer) + (name in readout.at) != 1:
            raise ValueError(f"{name!r} must be either in infer or in at")
    for name in study.categories:
        if name not in readout.at:
            raise ValueError(f"{name!r} is missing; put it in at")
    for name in readout.infer:
        check_values(study, name, [])
    for name, value in readout.at.items():
        check_values(study, name, [value])
    for name in readout.measured:
        if name not in study.outputs:
            raise ValueError(f"{name!r} is not one of surrogate.outputs")


def check_target(study: Contents, target: Target) -> None:
    """Raise ValueError unless a target asks for every factor once, within its range, and for learned outputs."""
    named = [*target.over, *target.at, *target.worst_case, *target.uncertain]
    for name in named:
        if named.count(name) > 1:
            raise ValueError(f"{name!r} is given twice; over, at, worst_case and uncertain exclude each other")
        check_values(study, name, target.values(name))
    for name in (*study.factors, *study.categories):
        if name not in named:
            places = "over, at, worst_case or uncertain" if name in study.factors else "over or at"
            raise ValueError(f"{name!r} is missing; put it in {places}")
    for name in target.names():
        varied = name in study.factors or name in CONSTANTS
        if name in FACTORS and not varied and not isinstance(study.held(name), float | int):
            raise ValueError(f"{name!r} {_lack(study, name) or 'has no value in this study'}")
        if name in ALL_QUANTITIES and name not in study.outputs:
            searched = name in ALL_PEAKS.keys() - study.absent - study.searched
            needs = "needs dataset: peaks: true" if searched else _lack(study, name)
            raise ValueError(f"{name!r} {needs or 'is not one of surrogate.outputs'}")
    for name in target.tolerance:
        with located(f"tolerance: {name}"):
            _check_tolerance(study, name, target)
    for name in (name for name in target.constants() if name not in study.factors):
        for narrowed in study.chosen(target):
            narrowed.constant(name)


def _check_tolerance(study: Contents, name: str, target: Target) -> None:
    """Raise ValueError where a tolerance leaves no value whose whole tolerance is within the study's range."""
    if name not in study.factors:
        raise ValueError("a category has none")
    axis, tolerance = study.factors[name], target.tolerance[name]
    if target.tolerances[name][1] and axis.low <= 0:
        raise ValueError(f"{tolerance} of what may be 0 is none; must have a unit [{FACTORS[name].units}]")
    low, high = target.room(name, axis.low, axis.high)
    if name in target.continuous:
        low, high = target.range(name, low, high)
    if not low < high:
        raise ValueError(f"{tolerance} is larger than the range {axis.low:g} to {axis.high:g} leaves room for")
    for value in target.variables[name].choices:
        if isinstance(value, str) or not low <= value <= high:
            raise ValueError(f"{tolerance} of {value} is not within {axis.low:g} to {axis.high:g}")


def _lack(study: Contents, name: str) -> str:
    """Return the reason for which no case has a quantity or factor; empty if the body is not the reason."""
    if name in _OF_FILMS and not study.kind.layered:
        return f"is a film's: a {study.kind.unbounded} has none"
    return f"is not one of surrogate.outputs{alternative}" if (alternative := _instead(study, name)) else ""


def _instead(study: Contents, name: str) -> str:
    """Return the quantities that cases have in place of one that their kind of body lacks, or why heat is lacking."""
    kind = study.kind
    if name in HEAT_QUANTITIES:
        return "".join(f"; {line}" for line in study.defaults if line.startswith("heat: "))
    if name not in ALL_PEAKS or name in kind.peaks:
        return ""
    if not kind.peaks:
        return f": no {kind.name} has a quantity of its inside"
    peaks = [peak for peak in kind.peaks if peak.endswith(name.removeprefix("film_").removeprefix("base_"))]
    return f": a {kind.name} has {' and '.join(peaks)}" if peaks else ""


def check_values(study: Contents, name: str, values: Sequence[float | str]) -> None:
    """Raise ValueError unless the study has a factor or category, and values lie in its range or among its names."""
    if name in study.categories:
        for value in values:
            if value not in study.categories[name]:
                raise ValueError(f"{name}: {value!r} is not one of {', '.join(study.categories[name])}")
        return
    if name not in study.factors:
        known = ", ".join((*study.factors, *study.categories))
        raise ValueError(f"{name!r} is not one of the study's factors: {known}")
    axis = study.factors[name]
    for value in values:
        if isinstance(value, str):
            raise ValueError(f"{name}: {value!r} is not a number")
        if not axis.low <= value <= axis.high:
            end = "low" if value < axis.low else "high"
            message = f"{name} = {value:g} is not within {axis.low:g} to {axis.high:g}"
            raise ValueError(f"{message}, the range of the study (factors: {name}: {end})")
