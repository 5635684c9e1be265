"""The report: one self-contained HTML page from the files of a study."""

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from solver.names import ALL_QUANTITIES
from storage.netcdf import read_whole
from surrogate import load
from workflow.dataset import draws
from workflow.dataset.slabs import CARD
from workflow.design.verdict import leftout, netcdf
from workflow.language.factors import FACTORS
from workflow.language.numbers import counted, number, shown
from workflow.language.titles import capital, in_words, listed, title, value
from workflow.learning.timing import by_quantity
from workflow.report import firstscreen, ranked, sections, sentences, tables, whatif
from workflow.report.svg import element
from workflow.study import coupling
from workflow.study.datum import HANGING, length
from workflow.study.model import Study

#: Factors that take a name, in words.
_MEANINGS = {
    "material": "material under the punch",
    "base": "what a film lies on",
    "composite": "kind of composite",
    "profile": "shape of the punch",
    "punch": "what the punch is made of",
    "surroundings": "what is beside the contact",
    "corner": "sharp edge of the punch",
    "electric": "the punch in the electric field",
    "magnetic": "the punch in the magnetic field",
    "interface_electric": "the film's interface in the electric field",
    "interface_magnetic": "the film's interface in the magnetic field",
}

#: Symbols, with their equations in docs/theory.md, of the factors of the paper's sweeps (Section 5).
_SYMBOLS = {
    "friction": ("η", "1.1"),
    "radius": ("R", "1.1"),
    "load": ("P", "1.2"),
    "charge": ("T", "1.2"),
    "magnetic_charge": ("J", "1.2"),
}
_COMMENT = re.compile(r"^\s*//.*\n|^ +", re.MULTILINE)
_LEAST = 1e-5  # share that is shown as more than none
_MOST_DRAWN = 6  # layers of a body whose names have room in its drawing
_TOP, _BOTTOM = 150, 294  # of all layers in the drawing
_SHOWN = 0.72  # size of drawings on the page, where their letters are as large as the text
#: Scripts of the page, in the order in which they need each other.
_SCRIPTS = (
    "contents.js", "numbers.js", "hover.js", "surrogate.js", "largest.js", "stack.js", "chart.js", "fields.js",
    "judging.js", "explore.js", "share.js", "whatif.js", "effects.js",
)  # fmt: skip
#: Content that not every page has.
_OF_SOME = (
    "answers", "dataset", "datum_changes", "designs", "levels", "readouts", "signal", "surface", "whatif",
)  # fmt: skip
#: Captions of the figures, by the kind that their file names open with; Snakemake's own report shows the same ones.
CAPTIONS = Path(__file__).parent / "captions"
TEMPLATES = Path(__file__).parent / "templates"


TITLE = "A conducting punch slides on a magneto-electro-elastic half-plane"
ON_FILM = "A conducting punch slides on a film on its base"
ON_LAYERS = "A conducting punch slides on layers on their base"
AT_POINT = "A conducting ball is pressed into a body"


def page(
    study: Study,
    name: str,
    folder: Path,
    figures: list[Path],
    provenance: Path,
    levels: Sequence[str | Path] = (),
    pressed: Study | None = None,
) -> str:
    """Return the page as text; ``pressed``: the study whose design is pressed in time, where it is another one."""
    card = _json(folder / CARD) if study.factors else {}
    hangs = frozenset(card.get("on_datum", HANGING if study.kind.datum == "relative" else ()))
    content: dict[str, Any] = dict.fromkeys(_OF_SOME, ()) | {
        "study": study,
        "name": name,
        "problem": _problem(study),
        "figures": {path.stem: _figure(path) for path in figures},
        "provenance": _json(provenance),
        "factors": FACTORS,
        "quantities": ALL_QUANTITIES,
        "meanings": _MEANINGS,
        "hanging": hangs,
        "datum": length(study),
        "kind": study.kind,
        "together": draws.TOGETHER,
        "tabled": study.tabled,
        "film_beside": study.effects.film if study.effects else {},
        "costly": study.costly.issuperset(study.quantities),
        "composites": coupling.composites(study),
        "scripts": [Markup(_COMMENT.sub("", (TEMPLATES / name).read_text(encoding="utf-8"))) for name in _SCRIPTS],
        "varied": bool(study.factors or study.effects),
        "effects": list(study.effects.vary) if study.effects else [],
        "symbols": _SYMBOLS if study.effects and study.kind.contact == "line" else {},
        "effects_table": tables.effects(study, folder) if study.effects else [],
        "verification": tables.verification(folder) if study.verification else None,
        "measurements": _json(folder / "measured/measurements.json") if study.measurements else [],
    }
    if study.factors:
        names = coupling.felt_outputs(study)
        content["dataset"] = tables.dataset(folder, card, coupling.felt_quantities(study))
        content["surface"] = tables.surface(folder / "surface_validation.nc") if study.surrogate.fields else None
        content["levels"] = tables.levels(Path(levels[0])) if levels else None
        content["sobol"] = tables.sobol(folder, coupling.outputs(study))
        content["distributed"] = listed([title(name) for name in study.distributions])
        content["validation"] = tables.validation(folder, study)
        content["timing"] = times = _json(folder / "timing.json")
        content["times"] = [row for row in by_quantity(study, times) if row["name"] in names]
        answers = [netcdf.read(folder / "design" / f"{target}.nc") for target in study.design]
        solved = _json(folder / "solved.json")
        exact = [solved["designs"][target] for target in study.design]
        content["datum_changes"] = solved["datum"]
        content["designs"] = [{"answer": answer, **solution} for answer, solution in zip(answers, exact, strict=True)]
        content["answers"] = [
            firstscreen.answered(study, *target, answer, solution)
            for target, answer, solution in zip(study.design.items(), answers, exact, strict=True)
        ]
        content["readouts"] = [tables.readout(name, folder / "readout" / f"{name}.nc") for name in study.readout]
        quantities = read_whole(folder / "quantities.nc")
        fields = load(folder / "surface.nc") if study.surrogate.fields else None
        content["whatif"] = whatif.content(study, load(folder / "surrogate.nc"), quantities, answers, hangs, fields)
        content["whatif_json"] = whatif.as_json(content["whatif"])
    if study.signal:
        content["signal"] = tables.signal(folder)
        if pressed is not None:
            label, page = study.signal.design, study.signal.study
            answer = netcdf.read(folder.parent / page / "design" / f"{label}.nc")
            solution = _json(folder.parent / page / "solved.json")["designs"][label]
            first = firstscreen.answered(pressed, label, pressed.design[label], answer, solution, page)
            content["answers"] = [first, *content["answers"]]
    if study.effects:
        drawn = ranked.draw(ranked.spans(content["effects_table"]))
        content["spans"] = element(drawn, "spans", "what each factor changes, the strongest first", 1.6)
    content["says"] = _says(study, folder, content, pressed or study)
    content |= {"parts": sections.standing(content), "page": content}
    return _environment().get_template("report.html.j2").render(content)


def _json(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


@cache
def _environment() -> Environment:
    """Return the templates of the page, with their functions and filters."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals |= {"figures_of": ranked.names, "most_left_out": leftout.MOST}
    environment.filters |= {
        "number": number,
        "seconds": _seconds,
        "words": lambda name: name.replace("_", " "),
        "title": title,
        "capital": capital,
        "share": _share,
        "spoken": in_words,
        "unbroken": firstscreen.unbroken,
        "si": shown,
        "value": value,
        "counted": counted,
    }
    return environment


def _says(study: Study, folder: Path, content: Mapping[str, Any], pressed: Study) -> dict[str, str]:
    """Return the sentence of every section that the page has."""
    says = {"provenance": sentences.provenance(content["provenance"]), "study": sentences.study(study)}
    if study.factors:
        validation, indices = content["validation"], read_whole(folder / "sensitivity.nc")
        says |= {
            "dataset": sentences.dataset(study, content["dataset"]["cases"], content["dataset"]["rows"]),
            "surrogate": sentences.surrogate(validation["worst"], validation["tolerance"]),
            "sensitivity": sentences.sensitivity(ranked.sensitivities(indices, coupling.aims(study))),
            "time": sentences.time(content["timing"]),
        }
    if content["surface"]:
        says["surface"] = sentences.surface(content["surface"])
    if content["answers"]:
        reached = sentences.reached({screen.title: screen.verdict for screen in content["answers"]})
        says |= {"reached": reached, "design": reached}
    if content["readouts"]:
        says["readout"] = sentences.readout(content["readouts"])
    if study.signal:
        on = f"the design {pressed.titles[study.signal.design]!r}"
        says["signal"] = sentences.signal(content["signal"], on)
    if study.effects:
        says["effects"] = sentences.strongest(ranked.spans(content["effects_table"]))
        says["varied"] = sentences.effects(content["effects_table"])
    if content["verification"]:
        says["speed"] = sentences.speed(content["verification"]["timings"])
    if content["measurements"]:
        says["measurements"] = sentences.measurements(content["measurements"])
    return says


def _problem(study: Study) -> Markup:
    """Return the drawing of a study's bodies: a half-plane, a film, or both."""
    effects, layers = study.effects, _layers(study) or ["film"]
    if study.kind.contact == "point":
        return _on_layers(layers if study.kind.layered else [], AT_POINT, point=True)
    of_films = study.kind.layered or (effects is not None and "thickness" in effects.baseline)
    half_plane = (TEMPLATES / "halfplane.svg").read_text(encoding="utf-8")
    drawings = [] if of_films else [element(half_plane, "problem", TITLE, _SHOWN)]
    if of_films or (effects is not None and effects.film):
        drawings.append(_on_layers(layers, ON_LAYERS if len(layers) > 1 else ON_FILM))
    return Markup("\n").join(drawings)


def _on_layers(layers: Sequence[str], title: str, *, point: bool = False) -> Markup:
    """Return the drawing of a contact on layers from the top down, or on a half-space."""
    edges = [round(_TOP + (_BOTTOM - _TOP) * number / max(len(layers), 1)) for number in range(len(layers) + 1)]
    drawn = _environment().get_template("film.svg.j2").render(title=title, layers=layers, edges=edges, point=point)
    return element(drawn, "film" if layers else "problem", title, _SHOWN)


def _layers(study: Study) -> list[str]:
    """Return the names of a body's layers for which a drawing has room."""
    names = [str(layer.material or layer.composite) for layer in study.body]
    return [names[0], f"{len(names) - 2} layers", names[-1]] if len(names) > _MOST_DRAWN else names


def _figure(path: Path) -> dict[str, Any]:
    kind, _, target = path.stem.partition("_")
    caption = (CAPTIONS / f"{kind}.rst").read_text(encoding="utf-8").replace("\n", " ").replace("``", "").strip()
    alt = f"{kind} {target.replace('_', ' ')}: {caption}".replace(" :", ":")
    svg = element(path.read_text(encoding="utf-8"), path.stem, alt, 1.9)
    return {"caption": caption, "svg": svg, "name": path.stem, "kind": kind}


def _seconds(value: float) -> str:
    """Return a time with a fitting unit, without kiloseconds."""
    return f"{number(value, 3)} s" if value >= 1 else shown(value, "s", 3)


def _share(part: float, digits: int) -> str:
    """Return a share in percent; 0 for next to none."""
    return f"{number(100 * part, digits) if abs(part) >= _LEAST else 0} %"
