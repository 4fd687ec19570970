"""Running studies, with their progress."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import IO, Any, NamedTuple

from .program import ProgramError, program
from .scenes import dumps
from .study import Study, StudyWarning

#: A scene: a dictionary, a file or the name of a built-in scene.
Scene = dict[str, Any] | str | os.PathLike[str]

_COUNTS = re.compile(r"(\d+)/(\d+) evaluations")


class Progress(NamedTuple):
    """A line that a running study prints."""

    text: str
    #: Evaluations that have ended; None in a line without counts.
    done: int | None
    #: Evaluations of the study at most; None in a line without counts.
    most: int | None

    def __str__(self) -> str:
        return self.text


def run(
    scene: Scene, out: str | os.PathLike[str], *, progress: Callable[[Progress], Any] | None = None, **options: Any
) -> Study:
    """Runs a study to its end and returns it as a `Study`.

    `scene` is a dictionary, a file or the name of a built-in scene, `out` the folder of the study. `progress` is called
    with a `Progress` for every line that the program prints meanwhile. Options are those of `coordinator run`, with `_`
    for `-`: `accuracy="draft"`, `workers=2`, `max_evaluations=60`; True sets a flag, a list or a dictionary repeats an option.

    An interruption (Ctrl-C, or that of a notebook) stops the study without loss, and `resume` goes on with it. A study
    that ended before its targets were met is returned with a StudyWarning; see `Study.targets_met` and `Study.ending`.
    What the program prints at its end is in `Study.printed`.

    Raises ProgramError.
    """
    with file_of(scene) as file:
        command = ["run", file, "--out", os.fspath(out), *words(options)]
        return _study(command, out, progress, hidden=file if isinstance(scene, dict) else None)


def resume(
    folder: str | os.PathLike[str], *, progress: Callable[[Progress], Any] | None = None, **options: Any
) -> Study:
    """Goes on with the study in `folder`, as `coordinator resume`, and returns it. See `run`."""
    return _study(["resume", os.fspath(folder), *words(options)], folder, progress)


@contextmanager
def file_of(scene: Scene) -> Iterator[str]:
    """The argument for a scene; a dictionary becomes a file in this folder, from which CSV files in it are looked up."""
    if not isinstance(scene, dict):
        yield os.fspath(scene)
        return
    handle, file = tempfile.mkstemp(prefix=".hingewise-", suffix=".toml", dir=".")
    try:
        with open(handle, "w", encoding="utf-8") as text:
            text.write(dumps(scene))
        yield file
    finally:
        os.unlink(file)


def words(options: Mapping[str, Any]) -> list[str]:
    """Command line options of keyword arguments."""
    found: list[str] = []
    for key, value in options.items():
        option = "--" + key.replace("_", "-")
        if isinstance(value, Mapping):
            value = [f"{name}={entry}" for name, entry in value.items()]
        for entry in value if isinstance(value, (list, tuple)) else [value]:
            if entry is True:
                found.append(option)
            elif entry is not None and entry is not False:
                found += [option, str(entry)]
    return found


def _study(
    arguments: list[str],
    folder: str | os.PathLike[str],
    progress: Callable[[Progress], Any] | None,
    hidden: str | None = None,
) -> Study:
    """Runs a command that ends with a finished study in `folder`; `hidden` is a file that messages do not name."""
    command = [program(), *arguments]
    # A file takes as much as is printed while the other stream is read.
    with tempfile.TemporaryFile("w+", encoding="utf-8") as printed:
        _run_to_end(command, printed, progress, hidden)
        printed.seek(0)
        study = Study(folder)
        study.printed = printed.read()
    if not study.targets_met:
        warnings.warn(f"{study.folder}: {study.ending}", StudyWarning, stacklevel=3)
    return study


def _run_to_end(
    command: list[str], printed: IO[str], progress: Callable[[Progress], Any] | None, hidden: str | None
) -> None:
    process = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=printed, stderr=subprocess.PIPE, encoding="utf-8"
    )
    assert process.stderr is not None
    said: list[str] = []
    try:
        for line in process.stderr:
            said = [*said, without(line.rstrip(), hidden)][-20:]
            if progress is not None:
                progress(_progress(said[-1]))
        process.wait()
    except BaseException:
        # Every finished evaluation is in the campaign file; a second signal would end the program at once.
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            process.stderr.read()
            process.wait()
        raise
    finally:
        process.stderr.close()
    if process.returncode != 0:
        raise ProgramError(process.returncode, "\n".join(said))


def without(line: str, hidden: str | None) -> str:
    """A message with `scene`, `rows` or `problem` in the place of a temporary file."""
    if hidden is None:
        return line
    base = os.path.basename(hidden)
    shown = "scene" if base.startswith(".") else base.split(".")[0]
    for name in (os.path.abspath(hidden), hidden, os.path.join(".", base), base):
        line = line.replace(name, shown)
    return line


def _progress(line: str) -> Progress:
    counts = _COUNTS.search(line)
    done, most = map(int, counts.groups()) if counts else (None, None)
    return Progress(line, done, most)
