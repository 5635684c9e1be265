"""A figure in fewer bytes is the same figure: outlines, places, words and styles."""

import io
import re
from xml.etree import ElementTree

import matplotlib.pyplot as plt
import numpy as np

from workflow.report.figures.compact import compacted
from workflow.report.figures.style import styled

SVG = "{http://www.w3.org/2000/svg}"


def outlines(text: str) -> list[list[complex]]:
    """Corners of every path, whether its lines go to places or by differences."""
    found = []
    for path in re.findall(r'\sd="([^"]*)"', text):
        corners: list[complex] = []
        for letter, rest in re.findall(r"([A-Za-z])([^A-Za-z]*)", path):
            numbers = [float(one) for one in re.findall(r"-?\d*\.?\d+", rest)]
            if letter in "hv":
                corners.append(corners[-1] + numbers[0] * (1 if letter == "h" else 1j))
                continue
            for x, y in zip(numbers[::2], numbers[1::2], strict=True):
                corners.append(complex(x, y) + (corners[-1] if letter.islower() else 0))
        found.append(corners)
    return found


def styles(text: str) -> list[str]:
    """The style of every element that has one, wherever it is written."""
    rules = dict(re.findall(r"\.(\w+)\{([^}]*)\}", text))
    return [own or rules[name] for own, name in re.findall(r' style="([^"]*)"| class="([^"]*)"', text)]


@styled
def drawn() -> str:
    figure, axes = plt.subplots(1, 2)
    x = np.linspace(0, 40, 900)
    axes[0].plot(x, np.sin(x) * np.exp(-x), label="many steps")
    axes[0].legend()
    axes[1].scatter(x[:50], np.cos(x[:50]))
    axes[1].set_title("of $\\sigma_{xx}$")
    written = io.StringIO()
    figure.savefig(written, format="svg")
    return written.getvalue()


def test_a_compact_figure_shows_the_same() -> None:
    before = drawn()
    after = compacted(before)
    assert len(after) < 0.5 * len(before)
    for old, new in zip(outlines(before), outlines(after), strict=True):
        np.testing.assert_allclose(new, old, atol=0.008)  # half a hundredth of a point each way
    assert styles(after) == styles(before)
    texts = [[*ElementTree.fromstring(text).iter(f"{SVG}text")] for text in (before, after)]
    words = [["".join("".join(one.itertext()).split()) for one in some] for some in texts]
    assert words[0] == words[1]
    assert "manysteps" in words[1]
    clips = [re.findall(r"url\(#([^)]+)\)", text) for text in (before, after)]
    assert [clips[0].index(one) for one in clips[0]] == [clips[1].index(one) for one in clips[1]]
    assert {*clips[1], *re.findall(r'href="#([^"]+)"', after)} == set(re.findall(r'id="([^"]+)"', after))
