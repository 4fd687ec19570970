#!/usr/bin/env python3
"""Today's evaluation of `flapping-wing` against that of the first version, both built and run here and now.

The first version is the last commit before ideal joints, tables and the error estimate came in: one sample at a time,
one island after the other. It is checked out beside the repository's other work trees and removed again. Errors are the
largest over the checkpoints against today's `reference`, relative to the largest value of the life; times are
processor times of the whole command, the shortest of three taken in turn. Needs Python, Git with the whole history and the Rust
toolchain; builds below target/first-version, or below FIRST_VERSION_TARGET. Prints a table.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

FIRST = "3860449"
REPEATS = 3
OUTPUTS = ["max_wear_depth_m", "angular_velocity_difference_rpm"]
ROOT = Path(__file__).resolve().parents[2]


def built(tree, target):
    """The coordinator of a work tree."""
    command = ["cargo", "build", "--quiet", "--release", "--workspace", "--bins"]
    subprocess.run(command, cwd=tree, check=True, env={**os.environ, "CARGO_TARGET_DIR": str(target)})
    return (target / "release" / "coordinator").read_bytes()


def spent():
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return children.ru_utime + children.ru_stime


def evaluation(program, accuracy):
    """Processor time [s] and what was printed."""
    before = spent()
    command = [program, "simulate", "--scene", "flapping-wing", "--accuracy", accuracy]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return spent() - before, json.loads(done.stdout)


def error(found, reference, output):
    largest = max(map(abs, reference[output]))
    return max(abs(a - b) for a, b in zip(found[output], reference[output])) / largest


def main():
    known = subprocess.run(["git", "cat-file", "-e", f"{FIRST}^{{commit}}"], cwd=ROOT, capture_output=True)
    if known.returncode != 0:
        sys.exit(f"commit {FIRST} is not in this repository: clone it with its history")
    target = Path(os.environ.get("FIRST_VERSION_TARGET", ROOT / "target" / "first-version"))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        tree = folder / "tree"
        subprocess.run(["git", "worktree", "add", "--quiet", "--detach", tree, FIRST], cwd=ROOT, check=True)
        try:
            programs = {"first": built(tree, target), "today": built(ROOT, target)}
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", tree], cwd=ROOT, check=True)
        for name, program in programs.items():
            programs[name] = folder / name
            programs[name].write_bytes(program)
            programs[name].chmod(0o755)

        shortest, found = {}, {}
        for _ in range(REPEATS):
            for accuracy in ["draft", "balanced"]:
                for name, program in programs.items():
                    seconds, printed = evaluation(program, accuracy)
                    key = (accuracy, name)
                    shortest[key] = min(seconds, shortest.get(key, seconds))
                    found[key] = printed
        _, reference = evaluation(programs["today"], "reference")

    print("| accuracy | version | wear off by | asymmetry off by | time steps | cycles | time, first = 1 |")
    print("|" + " --- |" * 7)
    for (accuracy, name), seconds in shortest.items():
        printed = found[accuracy, name]
        off = [f"{100 * error(printed, reference, output):.2g} %" for output in OUTPUTS]
        counts = [str(printed["diagnostics"][key]) if key in printed["diagnostics"] else "" for key in ["steps", "simulated_cycles"]]
        print(f"| {accuracy} | {name} | {' | '.join(off + counts)} | {seconds / shortest[accuracy, 'first']:.2f} |")


main()
