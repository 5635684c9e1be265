"""Base class of models that wrap others."""

from collections.abc import Mapping, Sequence
from copy import copy
from typing import ClassVar, Self

from typing_extensions import override

from surrogate.face.model import GaussianProcess
from surrogate.transforms.groups import Grouping


class Transformed(GaussianProcess):
    """A model that wraps others, its members, and transforms their answers into its own."""

    CALIBRATED: ClassVar[tuple[str, ...]] = ()  # names of the members that `calibrate` changes
    grouping: Grouping | None = None  # groups of inputs on which the members are learnt

    @override
    @property
    def members(self) -> Mapping[str, GaussianProcess]:
        return {name: getattr(self, f"{name}_") for name in self.MEMBERS}

    @override
    def over(self, members: Mapping[str, GaussianProcess]) -> Self:
        model = copy(self)
        for name, member in members.items():
            setattr(model, f"{name}_", member)
        model.cases_ = members[self.MEMBERS[0]].cases_
        model._lay_out()
        return model

    @property
    @override
    def parts(self) -> int:
        return self.members[self.MEMBERS[0]].parts

    def _lay_out(self) -> None:
        """Set attributes that follow from the members; ValueError unless they fit."""

    @override
    def uncalibrated(self) -> Self:
        plain = {name: model.uncalibrated() for name, model in self.members.items() if name in self.CALIBRATED}
        model = self.over({**self.members, **plain})
        model.calibration_ = None
        return model

    def only(self, outputs: Sequence[str]) -> Self:
        """Return a cheaper model of these outputs, whose means agree within the compression of the members."""
        narrowed, behind = self._narrowed(outputs)
        part = narrowed.over({name: member.only(behind) for name, member in self.members.items()})
        if part.calibration_ is self.calibration_ is not None:  # the model's own calibration, not a member's
            part.calibration_ = self.calibration_.only([self.outputs_.index(name) for name in outputs])
        return part

    def _narrowed(self, outputs: Sequence[str]) -> tuple[Self, Sequence[str]]:
        """Return a copy with these outputs, over the same members, and a member's outputs from which they follow."""
        raise NotImplementedError


def groups_of(model: GaussianProcess) -> Grouping | None:
    """Return the groups of inputs over which a model is learnt, None if it is learnt over the inputs."""
    return model.grouping if isinstance(model, Transformed) else None
