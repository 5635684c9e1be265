"""Draw the pictures of the documentation and write the list of modules: ``python -m docs``, as `make docs` does."""

from docs import badges, picture, rooms
from workflow.calculator import page
from workflow.report import problem


def write() -> None:
    """Write whatever in this folder is made from the code."""
    made = {
        "badges.svg": badges.draw(),
        "pipeline.svg": picture.draw(picture.arrows(picture.rulegraph())),
        "rooms.svg": rooms.draw(rooms.imports()),
        "problem.svg": problem.draw(),
        "film.svg": problem.film(),
        "calculator.html": page.page(),
        "architecture.md": rooms.listed(rooms.PAGE.read_text(encoding="utf-8")),
    }
    for name, text in made.items():
        (rooms.FOLDER / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write()
