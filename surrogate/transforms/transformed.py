"""Models whose answers follow from those of others: what all of them share, whatever the transform."""

from collections.abc import Mapping, Sequence
from copy import copy
from typing import ClassVar, Self

from typing_extensions import override

from surrogate.face.model import GaussianProcess
from surrogate.transforms.groups import Grouping


class Transformed(GaussianProcess):
    """A model that wraps others, its members, and turns their answers into its own.

    A transform gives answers from those of the members, and says which of their outputs stand behind its own. Parts,
    thinner, uncalibrated and stored models follow: those of the members, under the same transform.
    """

    CALIBRATED: ClassVar[tuple[str, ...]] = ()  # names of the members that `calibrate` changes
    grouping: Grouping | None = None  # groups of inputs that it stands on

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
        """Take from the members what answers need; ValueError unless they fit."""

    @override
    def uncalibrated(self) -> Self:
        plain = {name: model.uncalibrated() for name, model in self.members.items() if name in self.CALIBRATED}
        model = self.over({**self.members, **plain})
        model.calibration_ = None
        return model

    def only(self, outputs: Sequence[str]) -> Self:
        """Return the model of some outputs, over what stands behind these; it costs less to ask for.

        Where members are compressed, means agree within the compression's error.
        """
        behind = self._behind(outputs)
        part = self._narrowed(outputs).over({name: self.members[name].only(behind[name]) for name in self.MEMBERS})
        if part.calibration_ is self.calibration_ is not None:  # its own, not a member's
            part.calibration_ = self.calibration_.only([self.outputs_.index(name) for name in outputs])
        return part

    def _narrowed(self, outputs: Sequence[str]) -> Self:
        """The transform of some outputs, over members that still have all."""
        raise NotImplementedError

    def _behind(self, outputs: Sequence[str]) -> Mapping[str, Sequence[str]]:
        """Return, by member, the outputs behind the named outputs of the model."""
        raise NotImplementedError


def groups_of(model: GaussianProcess) -> Grouping | None:
    """Return the groups of inputs that a model stands on, None where it stands on the inputs."""
    return model.grouping if isinstance(model, Transformed) else None
