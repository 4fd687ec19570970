#!/usr/bin/env python3
"""Today's evaluation of `flapping-wing` against that of the first version, both built and run here and now.

The first version is the last commit before ideal joints, tables and the error estimate came in: one sample at a time,
one island after the other, one number at a time. Today's is that of HEAD. Of both the sources are unpacked without the
service, which takes no part, so that nothing of it need be built, and `evaluate.rs` beside this file is put among the examples. Errors
are the largest over the checkpoints against today's `reference`, relative to the largest value of the life; times are
processor times of the whole program, the shortest of REPEATS taken in turn.

Needs Python, the Rust toolchain and Git with the history. Prints a table.
"""

import io
import re
import resource
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

VERSIONS = {"first": "3860449", "today": "HEAD"}
REPEATS = 3
HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
MANIFEST = """
[package]
name = "worker"
version.workspace = true
edition.workspace = true

[dependencies]
common.workspace = true
libm.workspace = true
nalgebra.workspace = true
thiserror.workspace = true
tracing.workspace = true
"""


def built(commit, folder):
    """The example at a commit, built in this folder."""
    archive = subprocess.run(["git", "archive", commit], cwd=ROOT, check=True, capture_output=True).stdout
    with tarfile.open(fileobj=io.BytesIO(archive)) as packed:
        packed.extractall(folder, filter="data")
    workspace, worker = folder / "Cargo.toml", folder / "worker"
    workspace.write_text(re.sub("members = .*", 'members = ["common", "worker"]', workspace.read_text()))
    lanes = "pulp.workspace = true\n" if "pulp" in workspace.read_text() else ""
    (worker / "Cargo.toml").write_text(MANIFEST + lanes)
    (worker / "src" / "main.rs").unlink()
    library = worker / "src" / "lib.rs"
    library.write_text(re.sub("pub mod (service|simulator);", "", library.read_text()))
    (worker / "examples").mkdir(exist_ok=True)
    shutil.copy(HERE / "evaluate.rs", worker / "examples")
    command = ["cargo", "build", "--quiet", "--release", "-p", "worker", "--example", "evaluate"]
    subprocess.run([*command, "--target-dir", folder / "target"], cwd=folder, check=True)
    return folder / "target" / "release" / "examples" / "evaluate"


def evaluation(program, accuracy):
    """Processor time [s], counts of work, outputs by name."""

    def spent():
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return children.ru_utime + children.ru_stime

    before = spent()
    done = subprocess.run([program, accuracy], check=True, capture_output=True, text=True)
    seconds = spent() - before
    counts, *outputs = [line.split() for line in done.stdout.splitlines()]
    return seconds, counts, {name: [float(value) for value in values] for name, *values in outputs}


def error(found, reference):
    return max(abs(a - b) for a, b in zip(found, reference, strict=True)) / max(map(abs, reference))


def main():
    known = subprocess.run(["git", "cat-file", "-e", VERSIONS["first"] + "^{commit}"], cwd=ROOT, capture_output=True)
    if known.returncode != 0:
        sys.exit(f"commit {VERSIONS['first']} is not in this repository: clone it with its history")
    with tempfile.TemporaryDirectory() as folder:
        programs = {name: built(commit, Path(folder) / name) for name, commit in VERSIONS.items()}
        runs = {}
        for _ in range(REPEATS):
            for accuracy in ["draft", "balanced"]:
                for name, program in programs.items():
                    seconds, *found = evaluation(program, accuracy)
                    key = accuracy, name
                    runs[key] = (min(seconds, runs.get(key, (seconds,))[0]), *found)
        _, _, reference = evaluation(programs["today"], "reference")

    names = list(reference)
    print(f"| accuracy | version | {' | '.join(names)} | steps | refused | cycles | time, first = 1 |")
    print("|" + " --- |" * (len(names) + 6))
    for (accuracy, name), (seconds, counts, found) in runs.items():
        off = [f"{100 * error(found[output], reference[output]):.2g} %" for output in names]
        share = seconds / runs[accuracy, "first"][0]
        print(f"| {accuracy} | {name} | {' | '.join(off + counts)} | {share:.2f} |")


main()
