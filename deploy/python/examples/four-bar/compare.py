"""Forces and angles of the four-bar over one cycle: MuJoCo and Exudyn with ideal joints against the joints with clearance of Hingewise,
without friction and wear.

    python3 compare.py WORKER

prints a row of Markdown for each program and joint: the largest force here, the difference of the largest forces, the largest difference of
the forces over the cycle, both relative to it, and the largest difference of the angles.
"""

import importlib
import json
import subprocess
import sys
from math import hypot, remainder, tau

PERIOD = 1 / 15
SAMPLE = {"load_torque": -0.8, "friction": 1e-9}
JOINTS = ("crank", "coupler", "rocker")


def built_in(worker):
    """The cycle of the built-in mechanics on unworn surfaces."""
    surfaces = {name: {"bushing": [0.00403] * 36, "journal": [0.004] * 36} for name in JOINTS}
    request = {"id": 0, "cycle": 0, "sample": SAMPLE, "accuracy": "balanced", "joints": surfaces}
    command = [worker, "--serve-cycle", "four-bar"]
    done = subprocess.run(command, input=json.dumps(request) + "\n", capture_output=True, text=True, check=True)
    return json.loads(done.stdout)["joints"]


def at(time, values, t):
    """Linear interpolation."""
    k = next((k for k in range(1, len(time)) if time[k] >= t), len(time) - 1)
    share = (t - time[k - 1]) / (time[k] - time[k - 1])
    return values[k - 1] + share * (values[k] - values[k - 1])


def compared(program, joints):
    """Rows of a program: joint, largest force [N], and the differences."""
    reply = importlib.import_module(program).cycle({"period": PERIOD, "sample": SAMPLE})
    for name in JOINTS:
        own, other = joints[name], reply["joints"][name]
        largest = max(map(hypot, own["force_x"], own["force_y"]))
        peak = max(map(hypot, other["force_x"], other["force_y"]))
        forces, angles = [], []
        for k in range(0, len(reply["time"]), 5):
            t = reply["time"][k]
            x, y, angle = (at(own["time"], own[key], t) for key in ("force_x", "force_y", "angle"))
            forces.append(hypot(other["force_x"][k] - x, other["force_y"][k] - y))
            angles.append(abs(remainder(other["angle"][k] - angle, tau)))
        yield name, largest, peak / largest - 1, max(forces) / largest, max(angles)


if __name__ == "__main__":
    joints = built_in(sys.argv[1])
    print("| program | joint | largest force [N] | its difference | largest difference | angle [rad] |\n|---|---|---|---|---|---|")
    for program in ("mujoco_cycle", "exudyn_cycle"):
        for name, largest, peak, force, angle in compared(program, joints):
            tool = program.removesuffix("_cycle")
            print(f"| {tool} | {name} | {largest:.3f} | {100 * peak:+.2f} % | {100 * force:.2f} % | {angle:.1e} |")
