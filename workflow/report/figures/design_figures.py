"""Figures of a design, for the job that draws them and for the page that shows them."""

from workflow.study.target import Target


def names(target: Target) -> list[str]:
    """The figures of a target, in the order of the page; its contact, of which not every design has fields, is last."""
    continuous = len(target.continuous)
    names = ["front"] if len(target.objectives) > 1 else []
    names += ["map"] if continuous > 1 else []
    return [*names, *(["slices", "bars"] if continuous else [])]
