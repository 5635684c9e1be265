"""A figure in fewer bytes is the same figure: outlines, places, words and styles."""

import io
import re
from xml.etree import ElementTree

import matplotlib.pyplot as plt
import numpy as np

from workflow.report.figures.style import compacted, styled

SVG = "{http://www.w3.org/2000/svg}"


def outlines(text: str) -> list[list[complex]]:
    """Corners of every path, whether its lines go to places or by differences."""
    numbers_of_path = []
    for path in re.findall(r'\sd="([^"]*)"', text):
        corners: list[complex] = []
        for letter, text in re.findall(r"([A-Za-z])([^A-Za-z]*)", path):
            numbers = [float(number) for number in re.findall(r"-?\d*\.?\d+", text)]
            if letter in "hv":
                corners.append(corners[-1] + numbers[0] * (1 if letter == "h" else 1j))
                continue
            for x, y in zip(numbers[::2], numbers[1::2], strict=True):
                corners.append(complex(x, y) + (corners[-1] if letter.islower() else 0))
        numbers_of_path.append(corners)
    return numbers_of_path


def styles(text: str) -> list[str]:
    """The style of every element that has one, wherever it is written."""
    rules = dict(re.findall(r"\.(\w+)\{([^}]*)\}", text))
    return [style or rules[name] for style, name in re.findall(r' style="([^"]*)"| class="([^"]*)"', text)]


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
    words = [["".join("".join(element.itertext()).split()) for element in group] for group in texts]
    assert words[0] == words[1]
    assert "manysteps" in words[1]
    clips = [re.findall(r"url\(#([^)]+)\)", text) for text in (before, after)]
    assert [clips[0].index(element) for element in clips[0]] == [clips[1].index(element) for element in clips[1]]
    assert {*clips[1], *re.findall(r'href="#([^"]+)"', after)} == set(re.findall(r'id="([^"]+)"', after))
