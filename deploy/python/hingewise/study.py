"""The folder of a finished study as tables.

Columns have the names of `reliability.csv`, `samples.csv`, `campaign.db` and `summary.json`; the fields of a nested object
are joined with `_`. Units are those of these files: SI where a name states no other.
"""

import csv
import json
import sqlite3
import tomllib
from pathlib import Path

#: Form of `summary.json` that this package reads; later versions of the program add keys and change none of it.
SCHEMA = 1

#: Tables with the columns that number their rows.
TABLES = {
    "reliability": ["cycles"],
    "lives": ["limit_state", "level"],
    "moments": ["cycles"],
    "sensitivities": ["cycles", "limit_state", "variable"],
    "sobol": ["cycles", "limit_state", "variable"],
    "variables": ["name"],
    "limits": ["name"],
    "samples": ["id"],
    "outputs": ["evaluation", "cycles"],
    "output_errors": ["evaluation", "cycles"],
}


class StudyError(Exception):
    """A folder that holds no finished study, or one of another version."""


class StudyWarning(UserWarning):
    """A study that ended before its targets were met."""


class Study:
    """A finished study.

    Every table of `TABLES` is a property with a pandas frame, e.g. `study.lives`; `rows` gives it as a list of
    dictionaries. Files are read when they are needed, so a study that goes on in the folder needs a new `Study`.
    """

    #: What the program printed at the end of the study; None for a study that was opened from its folder.
    printed = None

    def __init__(self, folder):
        self.folder = Path(folder)
        file = self.folder / "summary.json"
        try:
            self.summary = json.loads(file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise StudyError(
                f"{self.folder}: no finished study; continue it with `coordinator resume {self.folder}`"
            ) from None
        except ValueError as fault:
            raise StudyError(f"{file}: {fault}") from None
        found = self.summary.get("schema") if isinstance(self.summary, dict) else None
        if found != SCHEMA:
            raise StudyError(f"{file}: has schema {found}, this package reads {SCHEMA}")

    def __repr__(self):
        return f"Study({str(self.folder)!r})"

    @property
    def targets_met(self):
        """True if the study ended because its targets were met; False if its budget was spent first."""
        return self.summary["convergence"]["targets_met"]

    @property
    def ending(self):
        """Why the study ended, in words."""
        met = "its targets are met" if self.targets_met else "ended before its targets were met"
        return f"{met}: {self.summary['convergence']['stopped_because']}"

    @property
    def scene(self):
        """The scene as it was studied, as a dictionary."""
        return tomllib.loads((self.folder / "scene.toml").read_text(encoding="utf-8"))

    def rows(self, table):
        """A table as a list of dictionaries; empty if the study has none of it."""
        if table not in TABLES:
            raise KeyError(f"{table}: the tables are {', '.join(TABLES)}")
        match table:
            case "reliability":
                return _csv(self.folder / "reliability.csv")
            case "samples":
                return [_without_outputs(row) for row in _csv(self.folder / "samples.csv")]
            case "outputs" | "output_errors":
                return self._database(table.removesuffix("s"))
            case "sensitivities":
                return [_flat(row) for row in self.summary["sensitivity"]]
            case "lives":
                return [_life(row) for row in self.summary["lives"]]
            case _:
                return [_flat(row) for row in self.summary[table]]

    def frame(self, table):
        """A table as a pandas frame."""
        import pandas

        frame = pandas.DataFrame(self.rows(table))
        return frame if frame.empty else frame.set_index(TABLES[table])

    def _database(self, table):
        """The rows of a table of `campaign.db` that belong to the result."""
        uri = (self.folder / "campaign.db").resolve().as_uri() + "?mode=ro"
        connection = sqlite3.connect(uri, uri=True)
        try:
            connection.row_factory = sqlite3.Row
            sql = f"SELECT * FROM {table} WHERE evaluation >= 0 ORDER BY evaluation, cycles"
            return [dict(row) for row in connection.execute(sql)]
        finally:
            connection.close()

    def __getattr__(self, name):
        if name in TABLES:
            return self.frame(name)
        raise AttributeError(f"{type(self).__name__} has no attribute {name}")

    def __dir__(self):
        return [*super().__dir__(), *TABLES]


def _csv(file):
    """The rows of a CSV file with numbers as such; an empty cell is None."""
    with open(file, newline="", encoding="utf-8") as text:
        return [{key: _value(cell) for key, cell in row.items()} for row in csv.DictReader(text)]


def _value(cell):
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            pass
    return cell or None


def _without_outputs(row):
    """A row of `samples.csv` without the outputs at every checkpoint, which the table `outputs` has."""
    return {key: value for key, value in row.items() if "@" not in key}


def _flat(row, prefix=""):
    """A nested object as one row."""
    flat = {}
    for key, value in row.items():
        if isinstance(value, dict):
            flat |= _flat(value, f"{prefix}{key}_")
        else:
            flat[prefix + key] = value
    return flat


def _life(row):
    """A life; the level of reliability is called so, since `reliability` is a curve."""
    flat = _flat(row)
    return {"limit_state": flat.pop("limit_state"), "level": flat.pop("reliability"), **flat}
