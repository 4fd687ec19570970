#!/usr/bin/env python3
"""Writes the wheel: the reader for Python, and the programs of a staged tree as its scripts.

    wheel.py TREE OUT PLATFORM

TREE has `bin` and `share` as `build.sh` fills them. A wheel is a zip archive with a list of its files (PEP 427), its
licences (PEP 639) and its bill of materials (PEP 770); no other tool is needed.
"""

import base64
import hashlib
import os
import sys
import time
import tomllib
import zipfile
from pathlib import Path

PYTHON = Path(__file__).resolve().parents[1] / "python"


def metadata(project, licences):
    """The file METADATA."""
    lines = [
        "Metadata-Version: 2.4",
        f"Name: {project['name']}",
        f"Version: {project['version']}",
        f"Summary: {project['description']}",
        f"License-Expression: {project['license']}",
        *(f"License-File: {name}" for name in licences),
        f"Requires-Python: {project['requires-python']}",
        *(f"Requires-Dist: {need}" for need in project["dependencies"]),
    ]
    for extra, needs in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f'Requires-Dist: {need}; extra == "{extra}"' for need in needs]
    return "\n".join(lines) + "\n"


def contents(tree, project, tag):
    """Contents by name in the archive, and the names of programs."""
    stem = f"{project['name']}-{project['version']}"
    info, doc = f"{stem}.dist-info", tree / "share/doc/hingewise"
    licences = ("LICENSE", "third-party-licences.txt")
    files = {f"hingewise/{file.name}": file.read_bytes() for file in (PYTHON / "hingewise").glob("*.py*") if file.is_file()}
    programs = {f"{stem}.data/scripts/{file.name}": file.read_bytes() for file in (tree / "bin").iterdir()}
    for part in ("man", "bash-completion", "zsh", "fish", "doc"):
        for file in (tree / "share" / part).rglob("*"):
            if file.is_file():
                files[f"{stem}.data/data/{file.relative_to(tree)}"] = file.read_bytes()
    files |= {f"{info}/licenses/{name}": (doc / name).read_bytes() for name in licences}
    files[f"{info}/sboms/sbom.cdx.json"] = (doc / "sbom.cdx.json").read_bytes()
    files[f"{info}/METADATA"] = metadata(project, licences).encode()
    wheel = f"Wheel-Version: 1.0\nGenerator: hingewise\nRoot-Is-Purelib: false\nTag: {tag}\n"
    files[f"{info}/WHEEL"] = wheel.encode()
    return files | programs, set(programs), info


def record(files, info):
    """The file RECORD: every file with its hash and size."""
    lines = []
    for name, content in sorted(files.items()):
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        lines.append(f"{name},sha256={digest},{len(content)}")
    return "\n".join([*lines, f"{info}/RECORD,,"]) + "\n"


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: wheel.py TREE OUT PLATFORM")
    tree, out, platform = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
    project = tomllib.loads((PYTHON / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    tag = f"py3-none-{platform}"
    files, programs, info = contents(tree, project, tag)
    # Zip archives know no time before 1980.
    stamp = max(int(os.environ.get("SOURCE_DATE_EPOCH", time.time())), 315532800)
    date = time.gmtime(stamp)[:6]
    target = out / f"{project['name']}-{project['version']}-{tag}.whl"
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in [*sorted(files.items()), (f"{info}/RECORD", record(files, info).encode())]:
            entry = zipfile.ZipInfo(name, date)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if name in programs else 0o100644) << 16
            archive.writestr(entry, content)


if __name__ == "__main__":
    main()
