"""Scenes as dictionaries: read from a file or the program, written as TOML."""

from __future__ import annotations

import datetime
import json
import os
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .program import output_of

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def load_scene(scene: str | os.PathLike[str]) -> dict[str, Any]:
    """The scene of a file, or the built-in one of this name, as a dictionary.

    Paths in it (CSV files, `extends`, the folder of a program) are made absolute, so that the dictionary is the same
    scene wherever it is run or saved.
    """
    path = Path(scene)
    if path.suffix or path.exists():
        return _with_absolute_paths(tomllib.loads(path.read_text(encoding="utf-8")), path.absolute().parent)
    return tomllib.loads(output_of("scenes", "--show", os.fspath(scene)))


def _with_absolute_paths(table: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Makes the paths of a scene that was read from this folder absolute, in place."""

    def settle(below: Any, key: str, default: str | None = None) -> None:
        value = below.get(key, default) if isinstance(below, dict) else None
        if isinstance(value, str):
            below[key] = str(folder / value)

    rows = [row for key in ("bodies", "loads", "outputs", "variables") for row in _rows(table, key)]
    for row in rows:
        for value in row.values():
            settle(value, "csv")
    head = table.get("scene")
    # The name of a built-in scene is no path.
    if isinstance(head, dict) and isinstance(head.get("extends"), str) and (folder / head["extends"]).is_file():
        settle(head, "extends")
    simulator = table.get("simulator")
    if isinstance(simulator, dict) and simulator.keys() & {"program", "fmu"}:
        settle(simulator, "folder", ".")
    return table


def _rows(table: dict[str, Any], key: str) -> list[dict[str, Any]]:
    rows = table.get(key)
    return [row for row in rows if isinstance(row, dict)] if isinstance(rows, list) else []


def save_scene(scene: dict[str, Any], file: str | os.PathLike[str]) -> None:
    """Writes a dictionary as the scene `file`."""
    Path(file).write_text(dumps(scene), encoding="utf-8")


def dumps(table: dict[str, Any]) -> str:
    """A dictionary as TOML.

    `tomllib.loads` gives the same dictionary again, in the same order but for values after tables, which TOML has no
    way to write.

    Raises TypeError for a value that TOML does not know, such as None.
    """
    return "".join(_table((), table)).lstrip("\n")


def _table(path: tuple[str, ...], table: dict[str, Any]) -> Iterator[str]:
    """The lines of a table: its values first, then the tables in it."""
    inner = [(key, value) for key, value in table.items() if _is_table(value) or _is_list_of_tables(value)]
    names = {key for key, _ in inner}
    for key, value in table.items():
        if key not in names:
            yield f"{_key(key)} = {_inline(value)}\n"
    for key, value in inner:
        name = ".".join(_key(part) for part in (*path, key))
        for entry in [value] if _is_table(value) else value:
            yield f"\n[{name}]\n" if _is_table(value) else f"\n[[{name}]]\n"
            yield from _table((*path, key), entry)


def _is_table(value: object) -> bool:
    return isinstance(value, dict)


def _is_list_of_tables(value: object) -> bool:
    return isinstance(value, (list, tuple)) and len(value) > 0 and all(map(_is_table, value))


def _key(key: object) -> str:
    if not isinstance(key, str):
        raise TypeError(f"key {key!r}: a text is expected")
    return key if _BARE.fullmatch(key) else _text(key)


def _text(text: str) -> str:
    # The escapes of JSON are escapes of TOML, which also forbids DEL.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _inline(value: Any) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return _text(value)
        case int():
            return str(value)
        case float():
            # Python's shortest form: a point or an exponent, `inf` and `nan`, as in TOML.
            return float.__repr__(value)
        case datetime.datetime() | datetime.date() | datetime.time():
            return value.isoformat()
        case list() | tuple():
            return "[" + ", ".join(map(_inline, value)) + "]"
        case dict():
            return "{ " + ", ".join(f"{_key(key)} = {_inline(entry)}" for key, entry in value.items()) + " }"
        case _ if hasattr(value, "item"):
            # A number of numpy.
            return _inline(value.item())
    raise TypeError(f"{value!r}: TOML has no such value")
