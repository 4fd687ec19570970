"""Hingewise against SciPy's LSODA with a numba right-hand side, on the same life of the same mechanism, in one session.

`compare.py HINGEWISE`, the built example `lsoda_hingewise`; `run.sh` beside this file builds it and calls this. Prints a table.

Each program has a reference of its own: here a compiled Runge-Kutta method, 20 000 steps a turn, a wear step of second
order every 250 cycles; there the preset `reference`. Errors are the largest over the checkpoints, relative to the largest value
of the life. Times are processor times, which other programs on the machine disturb least; those of Hingewise are measured alone, one
evaluation after the other, and in a batch that shares the vector lanes of one core. Against each way to integrate in
Python stands the quickest setting of Hingewise none of whose errors is larger.
"""

import json
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from slider_crank import Life, Scene, compiled, lsoda

HERE = Path(__file__).resolve().parent
SCENE = HERE / "slider-crank.toml"
OUTPUTS = ["wear", "pin_force", "slider_error"]
TOLERANCES = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9]
JUMP = 1000
REPEATS = 3
BATCH = 16
# step_tolerance, largest_step, wear_samples, cycle_jump, wear_tolerance
SETTINGS = ["draft", "balanced"] + [
    f"{step},{largest},{samples},{jump},{wear}"
    for step, largest in [(5e-3, 0.004), (0.02, 0.01), (0.05, 0.01), (0.1, 0.01), (0.2, 0.01), (0.5, 0.01)]
    for samples, jump, wear in [(150, 1000, 0.05), (300, 4000, 0.05), (300, 6000, 0.05), (150, 9000, 0.1), (150, 18000, 0.2)]
]
# Steps a turn of the same Python program with compiled Runge-Kutta steps in the place of `solve_ivp`.
COMPILED = [2000, 4000, 8000]


def hingewise(program, repeats, setting):
    """What it found, and the processor time of one evaluation [s]; `repeats` evaluations, in a batch if it is text that begins with x."""

    def spent():
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return children.ru_utime + children.ru_stime

    before = spent()
    done = subprocess.run([program, str(SCENE), str(repeats), setting], check=True, capture_output=True, text=True)
    return (spent() - before) / int(str(repeats).lstrip("x")), json.loads(done.stdout)


def table_of(line):
    """Outputs at the checkpoints `(m, 3)`."""
    return np.array([line["outputs"][name] for name in OUTPUTS]).T


def errors(found, reference):
    """Largest error of each output over the checkpoints, relative to the output's largest value `(3,)`."""
    return (np.abs(found - reference) / np.abs(reference).max(axis=0)).max(axis=0)


def row(*cells):
    print("| " + " | ".join(cells) + " |", flush=True)


def shown(errors):
    return [f"{100 * e:.2g} %" for e in errors]


def main():
    program = sys.argv[1]
    scene = Scene(SCENE)
    Life(scene, compiled(500), scene.cycles)  # compiles
    Life(scene, lsoda(1e-3), scene.cycles)
    ours = table_of(hingewise(program, 1, "reference")[1])
    theirs = Life(scene, compiled(20_000), 250, second_order=True).outputs[1:]
    print(f"The two references differ by {', '.join(shown(errors(theirs, ours)))} in {', '.join(OUTPUTS)}.\n")

    # In turn, so that whatever else the machine does meets all; the shortest time of each counts.
    ways = {f"LSODA, rtol {tolerance:.0e}": lsoda(tolerance) for tolerance in TOLERANCES}
    ways |= {f"compiled, {steps} steps": compiled(steps) for steps in COMPILED}
    lives, settings, batches, refused = {}, {}, {}, set()
    for _ in range(REPEATS):
        for name, way in ways.items():
            started = time.process_time()
            life = Life(scene, way, JUMP)
            seconds = time.process_time() - started
            lives[name] = (min(seconds, lives.get(name, (seconds,))[0]), life)
        for name in SETTINGS:
            seconds, line = hingewise(program, 2, name)
            if "failure" in line:
                refused.add(name)
            else:
                settings[name] = (min(seconds, settings.get(name, (seconds,))[0]), line)
                together, same = hingewise(program, f"x{BATCH}", name)
                assert same["outputs"] == line["outputs"], f"{name}: a batch has other results"
                batches[name] = min(together, batches.get(name, together))

    row("Python", *OUTPUTS, "calls", "Hingewise", *OUTPUTS, "forces", "cycles", "ratio of times", "in a batch")
    row(*["---"] * 13)
    for name, (seconds, life) in lives.items():
        off = errors(life.outputs[1:], theirs)
        as_good = [s for s in settings.values() if (errors(table_of(s[1]), ours) <= off).all()]
        left = [name, *shown(off), str(life.calls)]
        if not as_good:
            row(*left, "none as good", *[""] * 7)
            continue
        quickest, line = min(as_good, key=lambda s: s[0])
        counts = [str(line["forces"]), str(line["cycles"])]
        ratios = [f"{seconds / quickest:.1f}", f"{seconds / batches[line['setting']]:.1f}"]
        row(*left, line["setting"], *shown(errors(table_of(line), ours)), *counts, *ratios)

    print("\nAll settings of Hingewise, and how much quicker each is than LSODA at rtol 1e-7:\n")
    row("setting", *OUTPUTS, "forces", "cycles", "ratio of times", "in a batch")
    row(*["---"] * 8)
    against = lives["LSODA, rtol 1e-07"][0]
    for name, (seconds, line) in settings.items():
        counts = [str(line["forces"]), str(line["cycles"])]
        ratios = [f"{against / seconds:.1f}", f"{against / batches[name]:.1f}"]
        row(name, *shown(errors(table_of(line), ours)), *counts, *ratios)
    print(f"\nRefused: {', '.join(sorted(refused)) or 'none'}.")


main()
