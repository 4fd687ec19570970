"""The folder of a finished study as tables.

Columns have the names of `reliability.csv`, `samples.csv`, `campaign.db` and `summary.json`; the fields of a nested object
are joined with `_`. Units are those of these files: SI where a name states no other.
"""

from __future__ import annotations

import csv
import json
import os
import sqlite3
import tomllib
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas

#: Rows of a table.
Rows = list[dict[str, Any]]

#: Form of `summary.json` that this package reads; later versions of the program add keys and change none of it.
SCHEMA = 1

#: Tables with the columns that number their rows.
TABLES = {
    "reliability": ["cycles"],
    "parts": ["cycles", "limit_state"],
    "levels": ["limit_state"],
    "curves": ["limit_state", "cycles"],
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
    printed: str | None = None
    if TYPE_CHECKING:
        reliability: pandas.DataFrame
        curves: pandas.DataFrame
        lives: pandas.DataFrame
        moments: pandas.DataFrame
        sensitivities: pandas.DataFrame
        sobol: pandas.DataFrame
        variables: pandas.DataFrame
        limits: pandas.DataFrame
        samples: pandas.DataFrame
        outputs: pandas.DataFrame
        output_errors: pandas.DataFrame

    def __init__(self, folder: str | os.PathLike[str]) -> None:
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

    def __repr__(self) -> str:
        return f"Study({str(self.folder)!r})"

    @property
    def targets_met(self) -> bool:
        """True if the study ended because its targets were met; False if its budget was spent first."""
        return bool(self.summary["convergence"]["targets_met"])

    @property
    def ending(self) -> str:
        """Why the study ended, in words."""
        met = "its targets are met" if self.targets_met else "ended before its targets were met"
        return f"{met}: {self.summary['convergence']['stopped_because']}"

    @property
    def scene(self) -> dict[str, Any]:
        """The scene as it was studied, as a dictionary."""
        return tomllib.loads((self.folder / "scene.toml").read_text(encoding="utf-8"))

    @property
    def units(self) -> dict[str, str]:
        """Units of the frames: of variables, outputs and limits; `1` and an empty text: a number."""
        return {row["name"]: row["unit"] for key in ("limits", "units") for row in self.summary.get(key, [])}

    def in_units(self, table: str) -> pandas.DataFrame:
        """`samples`, `outputs` or `output_errors` in the units that the scene chooses, with them in the columns: `rod_length [mm]`."""
        frame, units = self.frame(table), self.summary.get("units", [])
        for row in units:
            if row["name"] in frame:
                frame[row["name"]] *= row["per_unit"]
        return frame.rename(columns={row["name"]: f"{row['name']} [{row['shown']}]" for row in units})

    def plot(self, ax: Any = None, limit_states: list[str] | None = None) -> Any:
        """R(n) with its 95 % interval, total and of every limit state; returns the axes. Needs matplotlib.

        The interval contains sampling, surrogates and numerical error.
        """
        known = [curve["limit_state"] for curve in self.summary["curves"]]
        if not known:
            raise StudyError(f"{self.folder}: has one checkpoint, and no curve over life")
        if unknown := [name for name in limit_states or [] if name not in known]:
            raise KeyError(f"{unknown[0]}: the limit states are {', '.join(known)}")
        if ax is None:
            from matplotlib import pyplot

            _, ax = pyplot.subplots()
        for curve in self.summary["curves"]:
            name = curve["limit_state"]
            if limit_states is None or name in limit_states:
                width = 2.0 if name == "total" else 1.0
                (line,) = ax.plot(curve["cycles"], curve["reliability"], label=name, linewidth=width)
                ax.fill_between(curve["cycles"], curve["lower"], curve["upper"], alpha=0.2, color=line.get_color())
        ax.set(xlabel="cycles", ylabel="R", ylim=(-0.02, 1.02), title=self.summary["scene"])
        ax.legend()
        return ax

    def _repr_html_(self) -> str:
        """The lives, or R of a study of one checkpoint, with their intervals and how the study ended, as a notebook shows them."""
        head: tuple[str, ...] = ("limit state", "R", "life [cycles]", "95 % interval")
        rows: list[tuple[str, ...]] = [(row["limit_state"], str(row["level"]), *_in_words(row)) for row in self.rows("lives")]
        if not rows:
            head, only = (*head[:2], head[3]), self.summary["reliability"][-1]
            limits = ((name, *of.values()) for name, of in only["interval"].items())
            rows = [(name, f"{only[name]:.6g}", f"{lower:.6g} to {upper:.6g}") for name, lower, upper in limits]
        lines = [f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in [head, *rows]]
        title = f"<b>{escape(self.summary['scene'])}</b>, {self.summary['evaluations']['total']} simulations, {escape(self.ending)}"
        return f"<div>{title}<table>{''.join(lines)}</table></div>"

    def rows(self, table: str) -> Rows:
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
                return [flat(row) for row in self.summary["sensitivity"]]
            case "parts":
                return [
                    {"cycles": row["cycles"], "limit_state": name, **parts}
                    for row in self.summary["reliability"]
                    for name, parts in row["parts"].items()
                ]
            case "levels":
                levels = self.summary.get("levels") or {"differences": []}
                return [flat(row) for row in levels["differences"]]
            case "curves":
                columns = ("cycles", "reliability", "lower", "upper")
                return [
                    {"limit_state": curve["limit_state"], **dict(zip(columns, values, strict=True))}
                    for curve in self.summary["curves"]
                    for values in zip(*(curve[column] for column in columns), strict=True)
                ]
            case "lives":
                return [_life(row) for row in self.summary["lives"]]
            case _:
                return [flat(row) for row in self.summary[table]]

    def frame(self, table: str) -> pandas.DataFrame:
        """A table as a pandas frame."""
        import pandas

        frame = pandas.DataFrame(self.rows(table))
        return frame if frame.empty else frame.set_index(TABLES[table])

    def _database(self, table: str) -> Rows:
        """The rows of a table of `campaign.db` that belong to the result."""
        uri = (self.folder / "campaign.db").resolve().as_uri() + "?mode=ro"
        connection = sqlite3.connect(uri, uri=True)
        try:
            connection.row_factory = sqlite3.Row
            sql = f"SELECT * FROM {table} WHERE evaluation >= 0 ORDER BY evaluation, cycles"
            return [dict(row) for row in connection.execute(sql)]
        finally:
            connection.close()

    def __getattr__(self, name: str) -> Any:
        if name in TABLES:
            return self.frame(name)
        raise AttributeError(f"{type(self).__name__} has no attribute {name}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *TABLES]


def _csv(file: Path) -> Rows:
    """The rows of a CSV file with numbers as such; an empty cell is None."""
    with open(file, newline="", encoding="utf-8") as text:
        return [{key: _value(cell) for key, cell in row.items()} for row in csv.DictReader(text)]


def _value(cell: str) -> int | float | str | None:
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            pass
    return cell or None


def _without_outputs(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row of `samples.csv` without the outputs at every checkpoint, which the table `outputs` has."""
    return {key: value for key, value in row.items() if "@" not in key}


def flat(row: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """A nested object as one row."""
    found: dict[str, Any] = {}
    for key, value in row.items():
        if isinstance(value, dict):
            found |= flat(value, f"{prefix}{key}_")
        else:
            found[prefix + key] = value
    return found


def _life(row: Mapping[str, Any]) -> dict[str, Any]:
    """A life; the level of reliability is called so, since `reliability` is a curve."""
    found = flat(row)
    return {"limit_state": found.pop("limit_state"), "level": found.pop("reliability"), **found}


def _in_words(life: Mapping[str, Any]) -> tuple[str, str]:
    """A life [cycles] with its interval; where it is not known, the life that it is beyond or before."""

    def shown(value: float | None) -> str:
        return "unknown" if value is None else f"{value:,.0f}".replace(",", " ") if value >= 1000 else f"{value:.4g}"

    lower, upper = life.get("interval_lower"), life.get("interval_upper")
    if life["cycles"] is not None:
        return shown(life["cycles"]), f"{shown(lower)} to {shown(upper)}"
    if upper is None:
        return (f"beyond {shown(lower)}" if lower else "not known"), ""
    return (f"before {shown(upper)}" if not lower else "not known"), f"{shown(lower)} to {shown(upper)}" if lower else ""
