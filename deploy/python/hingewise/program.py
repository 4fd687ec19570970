"""The program `coordinator`: where it is, and its commands."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sysconfig
from typing import Any

#: Environment variable with the path of the program, if it is neither in this environment nor on the search path.
VARIABLE = "HINGEWISE_COORDINATOR"


class ProgramError(Exception):
    """The program ended with an error; `code` is its exit code: 1 failure, 2 bad input, 130 interrupted; `printed` its results so far."""

    def __init__(self, code: int, message: str, printed: str = "") -> None:
        super().__init__(message)
        self.code = code
        self.printed = printed


def program() -> str:
    """Path of `coordinator`: that of the environment variable, of this Python environment, or of the search path."""
    found = (
        os.environ.get(VARIABLE)
        or shutil.which("coordinator", path=sysconfig.get_path("scripts"))
        or shutil.which("coordinator")
    )
    if not found:
        raise FileNotFoundError(f"coordinator is not installed; set {VARIABLE} to the path of the program")
    return found


def output_of(*arguments: object) -> str:
    """What a command prints, e.g. `output_of("scenes", "--show", "four-bar")`.

    Raises ProgramError with what it says.
    """
    command = [program(), "--quiet", *map(str, arguments)]
    ended = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8")
    if ended.returncode != 0:
        raise ProgramError(ended.returncode, ended.stderr.strip(), ended.stdout)
    return ended.stdout


def call(*arguments: object) -> Any:
    """The result of a command with `--json`: `call("simulate", "pendulum")`.

    Raises ProgramError with what it says.
    """
    return json.loads(output_of("--json", *arguments))
