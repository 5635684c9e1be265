"""First screen of the page: for each target a drawing to scale and the answer in sentences."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from solver import find
from solver.material.punches import RIGID_PUNCH
from solver.names import AIR, ANGLED_CUTS, CHOICES, COMPOSITES, FORMULAS, MIXTURES, PROFILES
from solver.stack.layers import RIGID
from workflow.design.verdict.answer import Answer, Term
from workflow.design.verdict.leftout import LeftOut
from workflow.design.wording.words import (
    UNREACHABLE,
    band,
    exceeded,
    first_to_break,
    in_brackets,
    spread,
    tolerances,
    verdict,
)
from workflow.language import titles
from workflow.language.factors import FACTORS
from workflow.language.numbers import number
from workflow.language.titles import capital, listed
from workflow.report import device, exact
from workflow.report.svg import element
from workflow.study import coupling
from workflow.study.model import Study
from workflow.study.target import Target

_AROUND = {AIR: "in air", "insulated": "insulated around"}
#: Radius that the section of a punch in space shows.
_SECTION = {"ellipsoid": "radius_x", "roller": "radius", "rough_sphere": "radius"}
_PUNCHES = {
    "flat": "flat punch {width} wide",
    "wedge": "wedge of slope {slope}",
    "half_cylinder": "half cylinder, R = {radius}",
    "sphere": "ball, R = {radius}",
    "cone": "cone of slope {slope}",
    "disc": "flat disc {width} wide",
    "power": "punch of profile {coefficient} r^{exponent}",
    "ellipsoid": "ellipsoid, R = {radius_x} and {radius_y}",
    "roller": "roller, R = {radius}, {length} long",
    "rough_sphere": "rough ball, R = {radius}, {roughness} rms",
}
_LITTLE = 1e-5  # share; smaller ones are shown as less than that
#: The space between a number and its unit: a sign, or a unit of the SI with or without prefix, and its divisor.
_UNIT = re.compile(r"(?<=\d) (?=(?:%|[fpnµmkMGT]?(?:m|N|V|A|C|F|K|Pa|s|T|Wb|J|W)(?:[·/²³][^\s,;]*)?)(?:[\s,;.)]|$))")
Case = Mapping[str, float | str]


@dataclass(frozen=True)
class Card:
    """Card of a target: three lines, and the sentences behind its "why"."""

    name: str  # key of the target
    title: str
    code: str  # goal and limits as the study writes them
    build: str  # body and punch with their tolerances
    does: str  # every goal with its spread and conditions
    stops: str  # binding limits
    doubt: str  # constants that the library marks as doubtful; empty without any
    beyond: str  # exceeded limits of materials and theory; empty without any
    breaks: str  # limit with the least room; empty without limits
    why: tuple[str, ...]  # further sentences
    verdict: str
    left_out: tuple[LeftOut, ...]  # effects that the model leaves out, the largest first
    drawing: Markup  # to scale
    page: str  # name of another study, on whose page this design stands; empty: on this page

    @property
    def reachable(self) -> bool:
        """Return whether some design satisfies every limit."""
        return self.verdict != UNREACHABLE


def answered(
    study: Study, name: str, target: Target, answer: Answer, solved: Mapping[str, Any], page: str = ""
) -> Card:
    """Return the card of one target; solved: its exact cases, as `workflow.report.exact` has them."""
    narrowed, judged = study.narrowed(answer.combination), verdict(answer)
    case: Case = {**study.fixed, **answer.combination, **answer.case}
    built = in_words(narrowed, case)
    moving = {str(row["name"]) for row in solved["on_datum"] if row["moves"]}
    reference = float(case.get("datum", FACTORS["datum"].default or 1.0))
    drawn = device.draw(of_case(study, case, solved["contact"]), built)
    why = (judged.beyond, judged.advice, judged.without_effect, judged.tolerance or cost(answer), judged.device,
           _sure(answer), spread(answer), exact.told(solved["around"]), judged.sources)  # fmt: skip
    return Card(
        title=study.titles[name],
        build=unbroken(built + in_brackets(answer)),
        does=unbroken(_good(target, answer, moving, reference)),
        stops=unbroken(capital(judged.stops)),
        doubt=doubted(narrowed),
        page=page,
        verdict=judged.kind,
        left_out=answer.left_out,
        drawing=element(drawn, f"device-{name}", f"{study.titles[name]}, drawn to scale: {built}"),
        name=name,
        code=answer.goal,
        beyond=unbroken(exceeded(answer)),
        breaks=unbroken(first_to_break(answer)),
        why=tuple(unbroken(reason) for reason in why if reason),
    )


def doubted(study: Study) -> str:
    """Return doubtful constants of the materials in use, in words; empty without any."""
    parts = []
    for material in coupling.materials(study):
        if material.note.startswith("doubt"):
            constants = {name for variant in material.alternatives for name in variant.constants}
            parts.append(f"{listed(sorted(constants)) or 'all'} of {material.name}")
    return f"uncertain constants: {listed(parts)}" if parts else ""


def of_case(study: Study, case: Case, contact: Mapping[str, float]) -> device.Device:
    """Return the drawing's data of a case."""
    profile = str(case.get("profile", CHOICES["profile"][0]))
    trailing, leading = study.kind.extents(contact)
    return device.Device(
        profile,
        str(case.get("corner", CHOICES["corner"][0])),
        float(case[_SECTION.get(profile, PROFILES[profile].needs[-1])]),
        trailing,
        leading,
        float(case[study.kind.loads.force]),
        case.get("electric", CHOICES["electric"][0]) == "conducting",
        study.body[0].at(case)["thickness"] if study.body else float(case["thickness"]) if study.kind.layered else None,
        _below(len(study.body) - 1, _base(case)),
        _grounded(study, case),
        float(case.get("exponent", 1.0)),
        float(case.get("friction", 0.0)) > 0,
        "top layer" if len(study.body) > 1 else "film",
    )


def _below(layers: int, base: str) -> str:
    """Layers below the top one and the base, in few words."""
    return base if layers < 1 else f"{layers} more layer{'s' if layers > 1 else ''} on {base}"


def _grounded(study: Study, case: Case) -> bool:
    """Return whether an electrode lies below the film, or below the top layer."""
    usual = CHOICES["interface_electric"][0]
    below = study.body[1].material if len(study.body) > 1 else case.get("base")
    if isinstance(below, str) and below != RIGID and find(below, study.own_materials).conductor:
        return True
    if study.body:
        return (study.body[0].below.electric or (usual if len(study.body) == 1 else "bonded")) == "grounded"
    return study.kind.layered and case.get("interface_electric", usual) == "grounded"


def in_words(study: Study, case: Case) -> str:
    """Return body and punch, and the surroundings if these are air or a device reads the contact."""
    around = str(case.get("surroundings", study.surroundings[0]))
    surroundings = f", {_AROUND[around]}" if study.device or around == AIR else ""
    return f"{body_in_words(study, case)}; {punch_in_words(case)}{surroundings}"


def body_in_words(study: Study, case: Case) -> str:
    """Return the body under the punch, as ``fibrous, 67 % BaTiO3, 230 µm on steel``."""
    if study.body:
        layers = [_layer(study, layer.plain(case), first=not k) for k, layer in enumerate(study.body)]
        return " on ".join([*layers, _base(case)])
    below = f" on {_base(case)}" if study.kind.layered else f", a {study.kind.unbounded}"
    return _layer(study, case) + below


def _layer(study: Study, case: Case, *, first: bool = True) -> str:
    """One layer, or the whole body, as ``Fibrous, 67 % BaTiO3, 230 µm``; with a small letter if not the first."""
    composite = str(case.get("composite", CHOICES["composite"][0]))
    if "material" in case:
        words = str(case["material"]) + (_cut(case) if first else "")
    elif composite not in MIXTURES:
        share = float(case[COMPOSITES[composite]])
        formula = FORMULAS.get(composite, f"{composite}, {titles.title(COMPOSITES[composite])} {{share}}")
        words = formula.format(rest=number(1 - share, 3), share=number(share, 3))
    else:
        composite = composite.capitalize() if first else composite
        words = f"{composite}, {number(100 * float(case['volume_fraction']), 3)} % {study.phases[0]}"
    return f"{words}, {titles.value('thickness', float(case['thickness']), 3)}" if "thickness" in case else words


def _cut(case: Case) -> str:
    """Cut of a crystal, as ``, rotated Y cut of 46 deg``."""
    cut = str(case.get("cut", ""))
    angle = f" of {number(float(np.degrees(float(case['cut_angle']))), 3)} deg" if cut in ANGLED_CUTS else ""
    return f", {cut} cut{angle}" if cut else ""


def _base(case: Case) -> str:
    if "base" in case:
        return "a rigid base" if case["base"] == "rigid" else str(case["base"])
    return f"a base of {titles.value('base_modulus', float(case['base_modulus']), 3)}" if "base_modulus" in case else ""


def punch_in_words(case: Case) -> str:
    """Return the punch, as ``R = 50 mm``, for a point with its material, as ``steel ball, R = 3 mm``."""
    profile, material = str(case.get("profile", CHOICES["profile"][0])), str(case.get("punch", RIGID_PUNCH))
    outline = PROFILES[profile]
    sizes = {name: titles.value(name, float(case[name]), 3) for name in outline.takes if name in case}
    crown = f", crown of {sizes['crown_radius']}" if "crown_radius" in sizes else ""
    words = _PUNCHES.get(profile, "R = {radius}").format(**sizes) + crown
    if outline.contact == "line" or material == RIGID_PUNCH:
        return words
    if material == "skin" and profile == "sphere":
        return f"fingertip, R = {sizes['radius']}"
    return f"{material.replace('_', ' ')} {words}"


def _good(target: Target, answer: Answer, moving: Collection[str], reference: float) -> str:
    """Return every goal's value with its spread, its datum if it depends on one, and the conditions."""
    datum = f" (ground {titles.value('datum', reference)} away)"
    parts = [f"{goal.title}{datum if goal.name in moving else ''} {_with_band(goal)}" for goal in answer.objectives]
    together = f", the compromise of {'both' if len(parts) == 2 else 'all'} goals" if len(parts) > 1 else ""
    names = {name for goal in answer.objectives for name in goal.statement.expression.names()}
    if names <= {*answer.case}:  # a factor as a goal
        over = "" if names.isdisjoint(target.tolerance) else ", tolerance included"
    else:
        over = _over(target)
    return capital(listed(parts)) + together + over


def _with_band(goal: Term) -> str:
    """Exact value of a goal with its spread by uncertain constants, without line breaks."""
    return f"{goal.shown(goal.exact)}{band(goal.spread)}".replace(" ", "\N{NO-BREAK SPACE}")


def _over(target: Target) -> str:
    """Conditions over which a goal counts, and how."""
    spans = [titles.span(name, *ends) for name, ends in target.ranges.items()]
    return f", {target.statistic.told} over {' and '.join(spans)}" if spans else ""


def cost(answer: Answer) -> str:
    """Cost of the tolerances, and of a 1 % error in every other variable that matters."""
    parts = tolerances(answer)
    for variable in answer.variables:
        error = variable.sensitivity
        if variable.chosen and error.matters and error.cost > 0 and not variable.tolerance:
            parts.append(f"an error of 1 % in {variable.title} costs {_share(error.cost)} of the goal")
    return f"{capital('; '.join(parts))}." if parts else ""


def _sure(answer: Answer) -> str:
    """Error of the surrogate at the exact value of the first goal."""
    goal = answer.terms[0]
    if not goal.exact:
        return "The values are exact."
    inside = "within" if goal.inside else "outside"
    return f"The values are exact; the surrogate differs by {_share(goal.error)}, {inside} its interval."


def unbroken(text: str) -> str:
    """Return a text whose numbers and units are not broken between lines."""
    joined = _UNIT.sub("\N{NO-BREAK SPACE}", text).replace(" = ", "\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}")
    return joined.replace("± ", "±\N{NO-BREAK SPACE}")


def _share(part: float) -> str:
    """Share in percent; a very small one as "less than"."""
    return f"{number(100 * part, 2)} %" if part > _LITTLE else f"less than {number(100 * _LITTLE, 1)} %"
