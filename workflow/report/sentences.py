"""First sentence of every section of the page, built from the section's numbers."""

import math
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

from solver.names import ALL_QUANTITIES
from workflow.design.wording.words import UNREACHABLE, unread
from workflow.device.signal import DROP, GONE
from workflow.language import titles
from workflow.language.numbers import counted, number, shown
from workflow.language.titles import capital, listed
from workflow.report.ranked import Chart
from workflow.study import coupling
from workflow.study.categories import parted, titled
from workflow.study.model import Study

Row = Mapping[str, Any]
_MOST_NAMED = 3  # categories that a sentence names
_LITTLE = 1e-4  # share of a charge that is reported as less than that


def reached(verdicts: Mapping[str, str]) -> str:
    """Sentence on which targets are reachable, by title."""
    missed = [title for title, verdict in verdicts.items() if verdict == UNREACHABLE]
    if not missed:
        several = "Both" if len(verdicts) == 2 else f"All {len(verdicts)}"
        return f"{'The target is' if len(verdicts) == 1 else f'{several} targets are'} reachable."
    verb = "is" if len(missed) == 1 else "are"
    return f"{capital(listed(missed))} {verb} not reachable ({len(missed)} of {len(verdicts)} targets)."


def study(study: Study) -> str:
    """Sentence on the factors that were varied."""
    body = "a film" if study.kind.layered else f"a {study.kind.unbounded}"
    where = f"{len(study.body)} layers" if len(study.body) > 1 else body
    if not study.factors:
        varied = listed([titles.title(name) for name in study.effects.vary]) if study.effects else "nothing"
        return f"On {where}, one factor at a time is varied: {varied}."
    names = [*map(titles.title, study.factors), *map(titles.title, study.categories)]
    varied = "one factor is" if len(names) == 1 else f"{len(names)} factors are"
    return f"On {where}, {varied} varied: {listed(names)}."


def dataset(study: Study, cases: int, rows: Sequence[Row]) -> str:
    """Number of cases, and the range of the first quantity of interest."""
    row = next((row for name in coupling.wanted(study) for row in rows if row["name"] == name), rows[0])
    ends = (shown(row[end], row["units"], 3) for end in ("low", "high"))
    return f"{counted(cases)} exact cases; {titles.title(str(row['name']))} ranges from {' to '.join(ends)}."


def surrogate(worst: Row, tolerance: float) -> str:
    """Largest error of the surrogate against the study's tolerance."""
    met = "met" if worst["error"] <= tolerance else "not met"
    share = f"{number(worst['error'], 2)} of the range ({titled(str(worst['name']))})"
    return f"The largest error is {share}; the tolerance of {number(tolerance, 2)} is {met}."


def surface(rows: Sequence[Row]) -> str:
    """Sentence on the field with the largest error."""
    worst = max(rows, key=lambda row: row["max_error"])
    return (
        f"The largest error of a field is {number(worst['max_error'], 2)} of its range ({titles.title(worst['name'])})."
    )


def sensitivity(charts: Sequence[Chart]) -> str:
    """Factor with the largest total Sobol' index of each quantity, by category where categories differ."""
    shares: dict[str, dict[str, dict[str, float]]] = {}  # by factor, quantity and names
    for chart in charts:
        quantity, kind = parted(chart.name)
        shares.setdefault(chart.bars[0].name, {}).setdefault(quantity, {})[kind] = chart.bars[0].high
    counts = Counter(parted(chart.name)[0] for chart in charts)
    parts = []
    for factor, depending in shares.items():
        names = [
            _depending(name, by_category, whole=len(by_category) == counts[name])
            for name, by_category in depending.items()
        ]
        words = [
            f"{name} ({_size(by_category.values())})"
            for name, by_category in zip(names, depending.values(), strict=True)
        ]
        parts.append(f"{listed(words)} depend{'s' if len(words) == 1 else ''} most on {titles.title(factor)}")
    return f"{capital('; '.join(parts))} (shares of the variance over the ranges, with interactions)."


def _depending(name: str, shares: Iterable[str], *, whole: bool) -> str:
    """Return a quantity, with its categories unless all are included."""
    names, quantity = list(shares), titles.title(name) if name in ALL_QUANTITIES else name
    others = [f"{len(names) - _MOST_NAMED} more"] if len(names) > _MOST_NAMED else []
    return quantity if whole else f"{quantity} of {listed([*names[:_MOST_NAMED], *others])}"


def _size(shares: Collection[float]) -> str:
    ends = dict.fromkeys(number(end, 2) for end in (min(shares), max(shares)))
    return f"{' to '.join(ends)} %"


def time(times: Mapping[str, float]) -> str:
    """Ratio of the times of solver and surrogate on scattered cases."""
    ratio = times["surrogate_mean_std_per_query"] / times["exact_per_scattered_case"]
    first, second = ("exact solver", "surrogate") if ratio > 1 else ("surrogate", "exact solver")
    return f"On scattered cases the {first} is {number(max(ratio, 1 / ratio), 2)} times faster than the {second}."


def readout(readouts: Sequence[Row]) -> str:
    """Width and coverage of the intervals that a read-out infers."""
    parts = [
        unread(row["name"], row["left"])
        or f"{titles.title(row['name'])} is determined to {number(100 * row['width'], 2)} %; its 95 % interval holds "
        f"the true value in {number(100 * row['coverage'], 3)} % of {counted(readout['cases'])} cases"
        for readout in readouts
        for row in readout["rows"]
    ]
    return f"{capital('; '.join(parts))}."


def signal(press: Row, on: str) -> str:
    """Output of a press, decay under a constant force, and noise."""
    constant = "A constant force gives a constant output: no charge leaks"
    if math.isfinite(press["time_constant"]):
        constant = (
            f"Under a constant force the output decays with the time constant {shown(press['time_constant'], 's', 3)}"
        )
        if press["drop"] < GONE:
            constant += f" ({number(100 * press['drop'], 2)} % in {DROP:g} s)"
    heat = ""
    if "heat_at_end" in press:
        share = abs(press["heat_at_end"] / press["contact_charge"])
        size = f"{number(100 * share, 2)} % of" if share < 1 else f"{number(share, 2)} times"
        size = size if share > _LITTLE else f"less than {number(100 * _LITTLE, 2)} % of"
        heat = f" Heat of what touches makes {size} the charge of the force by the end of the hold."
    return (
        f"{shown(press['force'], 'N', 3)} on {on} gives {shown(press['contact_output'], 'V', 3)} at the output. "
        f"{constant}. The noise is {shown(press['noise_charge'], 'C', 2)} or "
        f"{shown(press['noise_output'], 'V', 2)} at the output, which equals {shown(press['noise_force'], 'N', 2)}."
        f"{heat}"
    )


def checks(group: Row) -> str:
    """Number of passed checks of a group, and the check with the largest error over its tolerance."""
    passed = sum(check["passed"] for check in group["checks"])
    known = [check for check in group["checks"] if check["error"] is not None]
    text = f"{passed} of {len(group['checks'])} checks passed"
    if not known:
        return f"{text}."
    nearest = max(known, key=lambda check: check["error"] / check["tolerance"])
    share = number(100 * nearest["error"] / nearest["tolerance"], 2)
    return f"{text}; the largest error is {share} % of its tolerance ({nearest['name']})."


def speed(timings: Sequence[Row]) -> str:
    """Speed of the closed form over collocation."""
    ratios = [row["numerical"] / row["closed_form_batch"] for row in timings]
    return f"The closed form is {number(min(ratios), 2)} to {number(max(ratios), 2)} times faster than collocation."


def effects(rows: Sequence[Row]) -> str:
    """Sentence on the values of the factors that were varied one at a time."""
    spans = [f"{titles.title(row['name'])} {row['over']}" for row in rows]
    return f"Factors are varied one at a time: {'; '.join(spans)}."


def strongest(charts: Sequence[Chart]) -> str:
    """Factor of a parametric study with the largest effect on each quantity."""
    parts = [f"{chart.title} depends most on {chart.bars[0].title} ({chart.bars[0].words})" for chart in charts]
    return f"{capital('; '.join(parts))}."


def provenance(record: Row) -> str:
    """Files, study and sources that the numbers can be traced to."""
    return (
        f"{len(record['results_sha256'])} result files with digests, from study {record['study_sha256'][:8]} "
        f"and sources {record['sources_sha256'][:8]}."
    )


def measurements(rows: Sequence[Row]) -> str:
    """Number of published measurements that agree with the model."""
    count = Counter(row["verdict"] for row in rows)
    counts = (
        f"{count['agrees']} agree",
        f"{count['disagrees']} disagree",
        f"{count['cannot be told']} cannot be told",
    )
    return f"Of {len(rows) - count['predicted']} published values, without any constant fitted: {listed(counts)}."
