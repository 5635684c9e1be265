"""Quotes around the interpreter's path in the shell commands by which Snakemake starts scripts.

Snakemake 9 writes ``sys.executable`` into them as it is: a blank, a quote or a parenthesis in the path of the
environment ends every job. Its formatter knows ``:q``.
"""

import shlex
import sys
from typing import Any

from snakemake.script import PythonScript


def quote_interpreter() -> None:
    """Start scripts by the quoted path of the interpreter, if the path needs quotes."""
    if shlex.quote(sys.executable) == sys.executable:
        return
    execute = PythonScript._execute_cmd

    def quoted(script: PythonScript, command: str, **values: Any) -> Any:
        return execute(script, command.replace("{py_exec}", "{py_exec:q}"), **values)

    PythonScript._execute_cmd = quoted
