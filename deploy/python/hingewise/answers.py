"""Single evaluations, and questions to a finished study, each by the command of the same name.

Settings are dictionaries of keys of the scene, with a unit in the value: `{"parameters.width": "11 mm", "friction.std": "4 %"}`.
"""

from __future__ import annotations

import csv
import json
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .program import ProgramError, call, output_of
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
    return _of_scene("simulate", scene, set, options)


def check(scene: Scene, set: Settings | None = None, **options: Any) -> Answer:
    """Warnings of a scene, its linkage through the cycle and, without `quick=True`, its nominal life against the limits.

    A scene with faults has `valid` False and a list of `faults`. Raises ProgramError where there is no scene, or no life.
    """
    try:
        return _of_scene("check", scene, set, options)
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
    to_dict = getattr(samples, "to_dict", None)
    rows: Any = to_dict("records") if to_dict else samples

    def one(row: Settings) -> Answer | ProgramError:
        try:
            return simulate(file, row, **options)
        except ProgramError as error:
            return error

    with file_of(scene) as file, ThreadPoolExecutor(at_once or os.cpu_count()) as pool:
        return list(pool.map(one, rows))


def what_if(study: StudyOrFolder, set: Settings | None = None, **options: Any) -> Answer:
    """Reliability and lives for changed distributions, thresholds and correlations: `{"friction.std": 0.01, "wear.threshold": "9 um"}`."""
    return _of_study("what-if", study, {**options, "set": _pairs(set)})


def designs(study: StudyOrFolder, set: Settings | None = None, **options: Any) -> Answer:
    """Reliability and lives of every design of a study with design variables; `set={"parameters.width": "11 mm"}` for one of them."""
    chosen = set or options.pop("at", None)
    return _of_study("designs", study, {**options, "set": _pairs(chosen) if isinstance(chosen, Mapping) else chosen})


def optimise(study: StudyOrFolder, problem: Mapping[str, Any] | str | os.PathLike[str], **options: Any) -> Answer:
    """The cheapest means and tolerances that reach the targets; `problem` is a dictionary or a file of `coordinator optimise`."""
    if not isinstance(problem, Mapping):
        return _of_study("optimise", study, {**options, "problem": problem})
    with _file(".toml", dumps(dict(problem))) as file:
        return _of_study("optimise", study, {**options, "problem": file})


#: Observations: a file of `coordinator update` or `learn`, or rows (unit, cycles, quantity, value, error) of one.
Observations = str | os.PathLike[str] | Iterable[Sequence[Any]]


def update(study: StudyOrFolder, measured: Observations, **options: Any) -> Answer:
    """Reliability and remaining life of single units from what was measured of them, e.g. `[("A7", 30000, "max_wear_depth", "15 um", "1 um")]`."""
    with _observations(measured) as file:
        return _of_study("update", study, {**options, "measured": file})


def learn(study: StudyOrFolder, data: Observations, **options: Any) -> Answer:
    """Parameters of a population from its units, and reliability at `confidence`; see `coordinator learn --help` for the rows."""
    with _observations(data) as file:
        return _of_study("learn", study, {**options, "data": file})


def replace(study: StudyOrFolder, failure_cost: float, **options: Any) -> Answer:
    """The age, or the measured level, of replacement with the least cost."""
    return _of_study("replace", study, {**options, "failure_cost": failure_cost})


def weibull(data: Observations, study: StudyOrFolder | None = None, **options: Any) -> Answer:
    """Weibull distribution of lives, beside the reliability of a study; rows (unit, cycles, state, mode, from), or those of `update`."""
    given = {**options, "study": study.folder if isinstance(study, Study) else study}
    with _observations(data) as file:
        return Answer(call("weibull", file, *words(given)))


def test_plan(reliability: float, at: float, study: StudyOrFolder | None = None, **options: Any) -> Answer:
    """Units and cycles of a test that demonstrates a reliability at a life [cycles], with a study as prior."""
    given = words({**options, "reliability": reliability, "at": at})
    if study is None:
        return Answer(call("test-plan", *given))
    return Answer(call("test-plan", study.folder if isinstance(study, Study) else study, *given))


def _of_scene(command: str, scene: Scene, set: Settings | None, options: Mapping[str, Any]) -> Answer:
    with file_of(scene) as file:
        hidden = file if isinstance(scene, dict) else None
        try:
            printed = output_of("--json", command, file, *words({**options, "set": _pairs(set)}))
        except ProgramError as error:
            said = without(str(error), hidden), without(error.printed, hidden)
            raise ProgramError(error.code, *said) from None
        return Answer(json.loads(without(printed, hidden)))


def _of_study(command: str, study: StudyOrFolder, options: Mapping[str, Any]) -> Answer:
    folder = study.folder if isinstance(study, Study) else Path(study)
    return Answer(call(command, folder, *words(options)))


def _pairs(settings: Settings | None) -> list[str]:
    return [f"{key}={value}" for key, value in (settings or {}).items()]


@contextmanager
def _file(suffix: str, text: str) -> Iterator[str]:
    """A temporary file with this text."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"rows{suffix}"
        file.write_text(text, encoding="utf-8")
        yield str(file)


@contextmanager
def _observations(rows: Observations) -> Iterator[str]:
    if isinstance(rows, (str, os.PathLike)):
        yield os.fspath(rows)
        return
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "observations.csv"
        with open(file, "w", newline="", encoding="utf-8") as text:
            csv.writer(text).writerows(rows)
        yield str(file)
