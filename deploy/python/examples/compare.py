"""Forces and angles of mechanisms over one cycle by other programs against the joints with clearance of Hingewise.

    python3 compare.py WORKER [four-bar | drive]

prints a row of Markdown for each program and joint: the largest force here, the difference of the largest forces, the largest difference of
the forces over the cycle, both relative to it, and the largest difference of the angles. The four-bar in MuJoCo and in Exudyn has ideal joints
and is compared without friction; the drive in Exudyn has ideal joints, without friction here, and then joints with clearance by the same law.
By the same law both are also compared on bores that are worn in three places by 6 um, a fifth of the clearance of the four-bar.
"""

import json
import subprocess
import sys
from math import cos, hypot, remainder, tau
from pathlib import Path
from tempfile import TemporaryDirectory

EXAMPLES = Path(__file__).resolve().parent
sys.path[:0] = [str(EXAMPLES / folder) for folder in ("four-bar", "drive")]

# Friction that is none [1].
SMOOTH = 1e-9


def worn(radius):
    """Radii of a bore at 36 control points [m]."""
    return [radius + 3e-6 * (1 + cos(3 * tau * k / 36)) for k in range(36)]


def request(sample, names, bushing, journal):
    """A request for joints of these radii, of the bushing at its control points."""
    joints = {name: {"bushing": bushing, "journal": [journal] * 36} for name in names}
    return {"id": 0, "cycle": 0, "sample": sample, "accuracy": "balanced", "period": 1 / 15, "joints": joints}


def built_in(worker, scene, request):
    """The reply of the built-in mechanics to a request."""
    command = [worker, "--serve-cycle", scene]
    done = subprocess.run(command, input=json.dumps(request) + "\n", capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


class Column:
    """Values at ascending instants, interpolated linearly, each instant not before the last one."""

    def __init__(self, time, values):
        self.time, self.values, self.k = time, values, 1

    def at(self, t):
        while self.k < len(self.time) - 1 and self.time[self.k] < t:
            self.k += 1
        before, after = self.k - 1, self.k
        share = (t - self.time[before]) / (self.time[after] - self.time[before])
        return self.values[before] + share * (self.values[after] - self.values[before])


def print_rows(program, own, other):
    """A row for each joint of two replies."""
    for name, there in other["joints"].items():
        here = own["joints"][name]
        largest = max(map(hypot, here["force_x"], here["force_y"]))
        peak = max(map(hypot, there["force_x"], there["force_y"])) / largest - 1
        keys = "force_x", "force_y", "angle"
        columns = [Column(here.get("time", own.get("time")), here[key]) for key in keys]
        forces, angles = [], []
        for t, *values in zip(other["time"], *(there[key] for key in keys)):
            x, y, angle = (value - column.at(t) for value, column in zip(values, columns))
            forces.append(hypot(x, y))
            angles.append(abs(remainder(angle, tau)))
        force = max(forces) / largest
        print(f"| {program} | {name} | {largest:.3f} | {100 * peak:+.2f} % | {100 * force:.2f} % | {max(angles):.1e} |")


def four_bar(worker):
    import exudyn_cycle
    import mujoco_cycle

    def asked(sample, bushing):
        return request(sample, ("crank", "coupler", "rocker"), bushing, 4e-3)

    smooth = asked({"load_torque": -0.8, "friction": SMOOTH}, [4.03e-3] * 36)
    own = built_in(worker, "four-bar", smooth)
    for program, tool in ("mujoco", mujoco_cycle), ("exudyn", exudyn_cycle):
        print_rows(program, own, tool.cycle(smooth))
    for label, bushing in ("unworn", [4.03e-3] * 36), ("worn", worn(4.03e-3)):
        same = asked({"load_torque": -0.8}, bushing)
        print_rows(f"exudyn, same law, {label}", built_in(worker, "four-bar", same), exudyn_cycle.contact_cycle(same))


def drive(worker):
    import drive

    text = (EXAMPLES / "drive" / "drive.toml").read_text()
    cases = ("ideal joints", True, SMOOTH, 1), ("ideal joints, a tenth of the clearance here", True, SMOOTH, 0.1)
    same = ("same law", False, drive.FRICTION, 1), ("same law, worn", False, drive.FRICTION, 1)
    for label, ideal, friction, share in (*cases, *same):
        bushing = drive.JOURNAL + share * (drive.BUSHING - drive.JOURNAL)
        radii = worn(bushing) if label.endswith("worn") else [bushing] * 36
        with TemporaryDirectory() as folder:
            scene = Path(folder) / "drive.toml"
            scene.write_text(f'{text}\n[parameters]\nbushing_radius = "{bushing:.9g} m"\nfriction = {friction}\n')
            own = built_in(worker, str(scene), request({}, drive.JOINTS, radii, drive.JOURNAL))
        other = drive.cycle(friction, ideal, radii)
        print_rows(f"exudyn, {label}", own, other)
        torque = own["outputs"]["driving_torque"]
        peak = max(map(abs, other["torque"])) / torque - 1
        print(f"| exudyn, {label} | driving torque [N m] | {torque:.5f} | {100 * peak:+.2f} % | | |")


MECHANISMS = {"four-bar": four_bar, "drive": drive}

if __name__ == "__main__":
    chosen = sys.argv[2:] or list(MECHANISMS)
    for name in chosen:
        print("| program | joint | largest force [N] | its difference | largest difference | angle [rad] |\n|---|---|---|---|---|---|")
        MECHANISMS[name](sys.argv[1])
