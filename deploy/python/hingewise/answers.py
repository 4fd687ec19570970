"""Single evaluations, and questions to a finished study, each by the command of the same name.

Settings are dictionaries of keys of the scene, with a unit in the value: `{"parameters.width": "11 mm", "friction.std": "4 %"}`.
"""

from __future__ import annotations

import csv
import io
import json
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from .program import ProgramError, output_of
from .runs import Scene, file_of, words, without
from .scenes import dumps
from .study import Study, flat

if TYPE_CHECKING:
    import pandas

#: A finished study, or its folder.
StudyOrFolder = Study | str | os.PathLike[str]
#: Keys of a scene with their values, e.g. `{"rod_length": "40.05 mm"}`.
Settings = Mapping[str, Any]


class Answer(dict[str, Any]):
    """The JSON of a command; `frame` gives a list of it, e.g. `reliability` or `lives`, as a pandas frame."""

    def frame(self, key: str) -> pandas.DataFrame:
        """The rows of `key`; the fields of a nested object are joined with `_`."""
        import pandas

        return pandas.DataFrame([flat(row) for row in self[key]])


def simulate(scene: Scene = "flapping-wing", set: Settings | None = None, **options: Any) -> Answer:
    """One evaluation at these values of the random variables or other keys: outputs over life, motion, bores, stated errors.

    Options are those of `coordinator simulate`, e.g. `accuracy="draft"`. Raises ProgramError.
    """
    with file_of(scene) as file:
        return _ask("simulate", file, hidden=_hidden(scene, file), options={**options, "set": set})


def check(scene: Scene, set: Settings | None = None, **options: Any) -> Answer:
    """Warnings of a scene, its linkage through the cycle and, without `quick=True`, its nominal life against the limits.

    A scene with faults, or a missing one, has `valid` False and a list of `faults`. Raises ProgramError where there is no life.
    """
    try:
        with file_of(scene) as file:
            return _ask("check", file, hidden=_hidden(scene, file), options={**options, "set": set})
    except ProgramError as error:
        if error.code != 2 or not error.printed:
            raise
        return Answer(json.loads(error.printed))


def evaluate(
    scene: Scene, samples: Iterable[Any] | pandas.DataFrame, at_once: int | None = None, **options: Any
) -> list[Answer | ProgramError]:
    """Evaluations of your own samples or design of experiments: `simulate` for every row, some at once (default: one per core).

    Rows are dictionaries, or those of a pandas frame whose columns are keys of the scene, numbers in SI. A row that cannot be
    simulated has its ProgramError in the place of an answer.
    """

    def one(row: Settings) -> Answer | ProgramError:
        try:
            return _ask("simulate", file, hidden=_hidden(scene, file), options={**options, "set": row})
        except ProgramError as error:
            return error

    with file_of(scene) as file, ThreadPoolExecutor(at_once or os.cpu_count()) as pool:
        return list(pool.map(one, _records(samples)))


def what_if(study: StudyOrFolder, set: Settings | None = None, **options: Any) -> Answer:
    """Reliability and lives for changed distributions, thresholds and correlations: `{"friction.std": 0.01, "wear.threshold": "9 um"}`."""
    return _of_study("what-if", study, {**options, "set": set})


def designs(study: StudyOrFolder, set: Settings | None = None, **options: Any) -> Answer:
    """Reliability and lives of every design of a study with design variables; `set={"parameters.width": "11 mm"}` for one of them."""
    return _of_study("designs", study, {**options, "set": set or options.pop("at", None)})


def optimise(study: StudyOrFolder, problem: Mapping[str, Any] | str | os.PathLike[str], **options: Any) -> Answer:
    """The cheapest means and tolerances that reach the targets; `problem` is a dictionary or a file of `coordinator optimise`."""
    if not isinstance(problem, Mapping):
        return _of_study("optimise", study, {**options, "problem": problem})
    with _file("problem.toml", dumps(dict(problem))) as file:
        return _of_study("optimise", study, {**options, "problem": file}, file)


#: Columns of observations, and of lives.
OBSERVATION, LIFE = ("unit", "cycles", "quantity", "value", "error"), ("unit", "cycles", "state", "mode", "from")
#: Observations: a file of `coordinator update` or `learn`, or rows (unit, cycles, quantity, value, error) of one: tuples, dictionaries, or
#: a pandas frame with these columns.
Observations: TypeAlias = "str | os.PathLike[str] | Iterable[Sequence[Any] | Mapping[str, Any]] | pandas.DataFrame"


def update(study: StudyOrFolder, measured: Observations, **options: Any) -> Answer:
    """Reliability and remaining life of single units from what was measured of them, e.g. `[("A7", 30000, "max_wear_depth", "15 um", "1 um")]`."""
    with _observations(measured) as file:
        return _of_study("update", study, {**options, "measured": file}, file)


def learn(study: StudyOrFolder, data: Observations, **options: Any) -> Answer:
    """Parameters of a population from its units, and reliability at `confidence`; see `coordinator learn --help` for the rows."""
    with _observations(data) as file:
        return _of_study("learn", study, {**options, "data": file}, file)


def replace(study: StudyOrFolder, failure_cost: float, **options: Any) -> Answer:
    """The age, or the measured level, of replacement with the least cost."""
    return _of_study("replace", study, {**options, "failure_cost": failure_cost})


def weibull(data: Observations, study: StudyOrFolder | None = None, **options: Any) -> Answer:
    """Weibull distribution of lives, beside the reliability of a study; rows (unit, cycles, state, mode, from), or those of `update`."""
    given = {**options, "study": study.folder if isinstance(study, Study) else study}
    with _observations(data) as file:
        return _ask("weibull", file, hidden=file, options=given)


def test_plan(reliability: float, at: float, study: StudyOrFolder | None = None, **options: Any) -> Answer:
    """Units and cycles of a test that demonstrates a reliability at a life [cycles], with a study as prior."""
    given = {**options, "reliability": reliability, "at": at}
    return _ask("test-plan", options=given) if study is None else _of_study("test-plan", study, given)


def _ask(command: str, *given: object, hidden: str | None = None, options: Mapping[str, Any]) -> Answer:
    """The answer of a command, whose messages do not name the temporary file `hidden`."""
    try:
        printed = output_of("--json", command, *given, *words(options))
    except ProgramError as error:
        said = without(str(error), hidden), without(error.printed, hidden)
        raise ProgramError(error.code, *said) from None
    if not printed and options.get("out"):
        # Of some commands `out` is a file in place of what they print.
        out = Path(options["out"])
        printed = (out / f"{command}.json" if out.is_dir() else out).read_text(encoding="utf-8")
    return Answer(json.loads(without(printed, hidden)))


def _of_study(command: str, study: StudyOrFolder, options: Mapping[str, Any], hidden: str | None = None) -> Answer:
    return _ask(command, study.folder if isinstance(study, Study) else Path(study), hidden=hidden, options=options)


def _hidden(scene: Scene, file: str) -> str | None:
    return file if isinstance(scene, dict) else None


def _records(rows: Any) -> Any:
    """The rows of a pandas frame as dictionaries; other rows as they are."""
    to_dict = getattr(rows, "to_dict", None)
    return to_dict("records") if to_dict else rows


@contextmanager
def _file(name: str, text: str) -> Iterator[str]:
    """A temporary file of this name with this text."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / name
        file.write_text(text, encoding="utf-8", newline="")
        yield str(file)


@contextmanager
def _observations(rows: Observations) -> Iterator[str]:
    if isinstance(rows, (str, os.PathLike)):
        yield os.fspath(rows)
        return
    text, given = io.StringIO(), list(_records(rows))
    if given and isinstance(given[0], Mapping):
        names = OBSERVATION if "quantity" in given[0] else LIFE
        if unknown := [name for row in given for name in row if name not in names]:
            raise KeyError(f"{unknown[0]}: the columns are {', '.join(names)}")
        given = [names, *([row.get(name) for name in names] for row in given)]
    # Of a frame a missing value is a number that differs from itself.
    csv.writer(text).writerows([None if cell != cell else cell for cell in row] for row in given)
    with _file("rows.csv", text.getvalue()) as file:
        yield file
