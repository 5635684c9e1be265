"""Help of every command: an example that the command itself takes."""

import shlex

import pytest

from workflow.cli import main
from workflow.cli.helping import EXAMPLES


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_command_has_an_example_that_it_takes(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main.main([name, "--help"])
    told = capsys.readouterr().out
    words = shlex.split(told.split("example:\n")[1].replace("\\\n", " "))
    assert words[:2] == ["meecontact", name]
    assert callable(main._parser().parse_args(words[1:]).run)


def test_no_name_of_a_command_stands_alone_on_its_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.main([]) == 0
    lines = capsys.readouterr().out.splitlines()
    for name in EXAMPLES:
        assert any(len(line.split()) > 2 and line.split()[0] == name for line in lines), name
