# What every rule needs: the study behind a wildcard, and the hashes that say when a rule must run again.

from functools import cache

from workflow import factorial, provenance
from workflow import study as studies


@cache
def study_named(name):
    """The checked study; bad input ends the run with one line."""
    try:
        return studies.named(name)
    except studies.InputError as error:
        raise WorkflowError(str(error))


def study_of(wildcards):
    return study_named(wildcards.study)


def sections(*names):
    """Parameter of a rule: changes when these sections of the study change."""
    return lambda wildcards: study_of(wildcards).digest(*names)


PHYSICS = ("phases", "materials", "fixed", "factors")
