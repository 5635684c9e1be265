"""The sentence with which a section of the page opens: what its numbers say, made from them."""

import math
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

from solver.names import ALL_QUANTITIES
from workflow.design.wording.words import UNREACHABLE, Verdict, unread
from workflow.language import titles
from workflow.language.numbers import counted, number, shown
from workflow.language.titles import capital, listed
from workflow.report.tornado import Chart
from workflow.study import coupling
from workflow.study.categories import parted, titled
from workflow.study.model import Study

Row = Mapping[str, Any]
_MOST_NAMED = 3  # categories that a sentence names


def reached(verdicts: Mapping[str, Verdict]) -> str:
    """Which targets are reachable: the first line of a page where some are not."""
    missed = [title for title, verdict in verdicts.items() if verdict.kind == UNREACHABLE]
    if not missed:
        several = "Both" if len(verdicts) == 2 else f"All {len(verdicts)}"
        return f"{'The target is' if len(verdicts) == 1 else f'{several} targets are'} reachable."
    verb = "is" if len(missed) == 1 else "are"
    return f"{capital(listed(missed))} {verb} not reachable ({len(missed)} of {len(verdicts)} targets)."


def study(study: Study) -> str:
    """What was varied."""
    body = "a film" if study.kind.layered else f"a {study.kind.unbounded}"
    where = f"{len(study.body)} layers" if len(study.body) > 1 else body
    if not study.factors:
        varied = listed([titles.title(name) for name in study.effects.vary]) if study.effects else "nothing"
        return f"On {where}, one factor at a time is varied: {varied}."
    names = [*map(titles.title, study.factors), *map(titles.title, study.categories)]
    return f"On {where}, {len(names)} factors are varied: {listed(names)}."


def dataset(study: Study, cases: int, rows: Sequence[Row]) -> str:
    """How many cases, and how far the first quantity of interest goes."""
    row = next((row for name in coupling.wanted(study) for row in rows if row["name"] == name), rows[0])
    ends = (shown(row[end], row["units"], 3) for end in ("low", "high"))
    return f"{counted(cases)} exact cases; over them {titles.title(str(row['name']))} goes from {' to '.join(ends)}."


def surrogate(worst: Row, tolerance: float) -> str:
    """The largest error against what was asked."""
    met = "met" if worst["error"] <= tolerance else "not met"
    of = f"of range ({titled(str(worst['name']))})"
    return f"Largest error {number(worst['error'], 2)} {of}: asked {number(tolerance, 2)}, {met}."


def surface(rows: Sequence[Row]) -> str:
    """The field with the largest error."""
    worst = max(rows, key=lambda row: row["max_error"])
    return f"Largest error of a field {number(worst['max_error'], 2)} of its range: {titles.title(worst['name'])}."


def sensitivity(charts: Sequence[Chart]) -> str:
    """On which factor some outputs depend most: quantities, in each of their categories where these differ."""
    shares: dict[str, dict[str, dict[str, float]]] = {}  # by factor, quantity and names
    for chart in charts:
        quantity, kind = parted(chart.name)
        shares.setdefault(chart.bars[0].name, {}).setdefault(quantity, {})[kind] = chart.bars[0].high
    counts = Counter(parted(chart.name)[0] for chart in charts)
    parts = []
    for factor, depending in shares.items():
        names = [_depending(name, own, whole=len(own) == counts[name]) for name, own in depending.items()]
        said = [f"{name} ({_size(own.values())})" for name, own in zip(names, depending.values(), strict=True)]
        parts.append(f"{listed(said)} depend{'s' if len(said) == 1 else ''} most on {titles.title(factor)}")
    return f"{capital('; '.join(parts))}: shares of the variance over the box, interactions included."


def _depending(name: str, shares: Iterable[str], *, whole: bool) -> str:
    """A quantity, and the categories that are meant where these are not all."""
    names, quantity = list(shares), titles.title(name) if name in ALL_QUANTITIES else name
    more = [f"{len(names) - _MOST_NAMED} more"] if len(names) > _MOST_NAMED else []
    return quantity if whole else f"{quantity} of {listed([*names[:_MOST_NAMED], *more])}"


def _size(shares: Collection[float]) -> str:
    ends = dict.fromkeys(number(end, 2) for end in (min(shares), max(shares)))
    return f"{' to '.join(ends)} %"


def time(times: Mapping[str, float]) -> str:
    """Which of solver and surrogate is the faster, and how much."""
    ratio = times["surrogate_mean_std_per_query"] / times["exact_per_scattered_case"]
    first, second = ("exact solver", "surrogate") if ratio > 1 else ("surrogate", "exact solver")
    return f"On scattered cases the {first} is {number(max(ratio, 1 / ratio), 2)} times faster than the {second}."


def readout(readouts: Sequence[Row]) -> str:
    """How often the intervals held what they infer, and how wide they are."""
    parts = [
        unread(row["name"], row["left"])
        or f"{titles.title(row['name'])} is read to {number(100 * row['width'], 2)} %, and its 95 % interval held it "
        f"in {number(100 * row['coverage'], 3)} % of {counted(readout['cases'])} cases"
        for readout in readouts
        for row in readout["rows"]
    ]
    return f"{capital('; '.join(parts))}."


def signal(press: Row, on: str) -> str:
    """What the amplifier shows of a press, what a constant force does, and the noise."""
    constant = "A constant force is held: nothing leaks"
    if math.isfinite(press["time_constant"]):
        constant = (
            f"A constant force fades with the time constant {shown(press['time_constant'], 's', 3)}: "
            f"{number(100 * press['drop'], 2)} % less after 10 s"
        )
    return (
        f"{shown(press['force'], 'N', 3)} on {on} shows {shown(press['output'], 'V', 3)} at the output. "
        f"{constant}. The noise floor is {shown(press['noise_charge'], 'C', 2)}, "
        f"{shown(press['noise_output'], 'V', 2)} at the output, as much as {shown(press['noise_force'], 'N', 2)}."
    )


def checks(group: Row) -> str:
    """How many checks of a group are green, and which comes nearest to its tolerance."""
    green = sum(check["passed"] for check in group["checks"])
    known = [check for check in group["checks"] if check["error"] is not None]
    text = f"{green} of {len(group['checks'])} checks are green"
    if not known:
        return f"{text}."
    nearest = max(known, key=lambda check: check["error"] / check["tolerance"])
    share = number(100 * nearest["error"] / nearest["tolerance"], 2)
    return f"{text}; the largest error is {share} % of its tolerance ({nearest['name']})."


def speed(timings: Sequence[Row]) -> str:
    """How much faster than collocation the closed form is."""
    ratios = [row["numerical"] / row["closed_form_batch"] for row in timings]
    return f"The closed form is {number(min(ratios), 2)} to {number(max(ratios), 2)} times faster than collocation."


def effects(study: Study) -> str:
    """What was varied about which baseline."""
    assert study.effects is not None
    spans = []
    for name, values in study.effects.vary.items():
        said = [value.replace("_", " ") if isinstance(value, str) else titles.value(name, value) for value in values]
        named = isinstance(values[0], str)
        spans.append(f"{titles.title(name)} {', '.join(said) if named else f'{said[0]} to {said[-1]}'}")
    return f"Varied one at a time: {'; '.join(spans)}."


def strongest(charts: Sequence[Chart]) -> str:
    """Which factor of a parametric study moves each quantity most: the first bar of its chart."""
    parts = [f"{chart.title} changes most with {chart.bars[0].title} ({chart.bars[0].told})" for chart in charts]
    return f"{capital('; '.join(parts))}."


def provenance(given: Row) -> str:
    """What the numbers can be traced to."""
    return (
        f"{len(given['results_sha256'])} files of results, each with its digest, of study "
        f"{given['study_sha256'][:8]} and sources {given['sources_sha256'][:8]}."
    )


def measurements(rows: Sequence[Row]) -> str:
    """How many published measurements agree with the model."""
    count = Counter(row["verdict"] for row in rows)
    told = (f"{count['agrees']} agree", f"{count['disagrees']} disagree", f"{count['cannot be told']} cannot be told")
    return f"Of {len(rows)} published values, without any constant fitted: {listed(told)}."
