"""The published table of solved problems: its cheap rows come out again, and its reader judges other numbers."""

import csv

import pytest

from tests.programs import Command
from verification.benchmark import COLUMNS, MOST_DIGITS, PROBLEMS, Problem, units
from workflow.cli.benchmark import TABLE, verdict

ROWS = list(csv.DictReader(TABLE.read_text(encoding="utf-8").splitlines()))
#: Those that take a moment; the others take minutes of finite elements and of grids.
CHEAP = [problem for problem in PROBLEMS if not {"spectral finite elements", "grid of cells"} & {*problem.methods}]


def test_every_problem_has_rows_and_no_digit_that_one_method_lacks() -> None:
    assert list(dict.fromkeys(row["problem"] for row in ROWS)) == [problem.name for problem in PROBLEMS]
    assert len(PROBLEMS) == 17
    for row in ROWS:
        assert tuple(row) == COLUMNS
        printed = len(row["value"].partition("e")[0].lstrip("-").replace(".", ""))
        assert printed == min(int(row["digits"]), MOST_DIGITS)
        assert printed >= 3


@pytest.mark.parametrize("problem", CHEAP, ids=lambda problem: problem.name)
def test_cheap_rows_come_out_again(problem: Problem) -> None:
    expected = [row for row in ROWS if row["problem"] == problem.name]
    for row, number in zip(expected, problem.numbers(), strict=True):
        assert (number.quantity, units(number.quantity)) == (row["quantity"], row["units"])
        assert verdict(row["value"], number.first).startswith("agrees")
        assert number.digits >= int(row["digits"]) - 1  # the last may lie on either side of a rounding


@pytest.mark.parametrize(
    ("answer", "said"),
    [(None, "missing"), (-2228.757733, "agrees to the last digit"), (-2228.757735, "off by 1.3e-09")],
)
def test_verdicts(answer: float | None, said: str) -> None:
    assert verdict("-2.228757732e+03", answer) == said


def test_the_command_judges_each_row(command: Command) -> None:
    mine = [(row["problem"], row["quantity"], row["value"]) for row in ROWS[:3]]
    mine[1] = (*mine[1][:2], "1.1")
    text = "problem,quantity,value\n" + "".join(",".join(row) + "\n" for row in mine)
    lines = command("benchmark", command.file("answers.csv", text))[0].splitlines()
    assert len(lines) == len(ROWS) + 1
    assert [line.split(row["value"])[1].split()[0] for line, row in zip(lines, ROWS, strict=False)][:4] == [
        "agrees", "off", "agrees", "missing",
    ]  # fmt: skip
    assert lines[-1] == f"2 of 3 numbers agree to the last digit; {len(ROWS) - 3} are missing"
    assert len(command("benchmark")[0].splitlines()) == len(ROWS)


@pytest.mark.parametrize(("separator", "mark"), [(";", "."), ("\t", ",")])
def test_answers_of_any_spreadsheet_are_read(separator: str, mark: str, command: Command) -> None:
    mine = [(row["problem"], row["quantity"], row["value"].replace(".", mark)) for row in ROWS[:3]]
    lines = ["# of another code", *map(separator.join, [("problem", "quantity", "value"), *mine])]
    printed, _ = command("benchmark", command.file("answers.csv", "\n".join(lines)))
    assert printed.splitlines()[-1].startswith("3 of 3 numbers agree to the last digit;")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("problem,quantity,value\n", "is empty: needs the columns"),
        ("problem,value\ndisc-layer,1\n", "no column quantity; must have problem, quantity, value"),
        ("problem,quantity,value\ndisk-layer,contact_stiffness,1\n", "line 2: disk-layer: not in the table; "),
        ("problem,quantity,value\ndisc-layer,contact_stiffness,nan\n", "value: 'nan' is not a finite number"),
        (
            "problem,quantity,value\n" + 2 * "disc-layer,contact_stiffness,1\n",
            "line 3: disc-layer, contact_stiffness: given",
        ),
    ],
)
def test_bad_answers_are_refused_in_one_line(text: str, said: str, command: Command) -> None:
    assert said in command.refused("benchmark", command.file("answers.csv", text))
