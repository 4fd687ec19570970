"""Programs of other authors that give cycles: the examples and an FMU. Run by `tests/tests/packages.rs`; each test is skipped by the name
of the package that is missing."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLE = PACKAGE / "examples" / "four-bar"
sys.path[:0] = [str(PACKAGE), str(EXAMPLE)]

FMU_SCENE = """
[scene]
name = "slider-crank-fmu"
[simulator]
gives = "cycle"
tier = "reaction"
program = [PYTHON, "-m", "hingewise.fmu", "SliderCrank.fmu", "pin.force_x=pin_fx", "*.force_y=*_fy", "pin.angle=pin_turn", "peak=largest(torque)"]
[materials.steel]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
[[joints]]
name = "pin"
journal_radius = "5 mm"
radial_clearance = "30 um"
width = "10 mm"
journal_material = "steel"
bushing_material = "steel"
contact_law = "foundation"
wear_coefficient = "1e-13 1/Pa"
[[outputs]]
name = "wear"
type = "largest-wear"
[[outputs]]
name = "peak"
unit = "N m"
[[limit_states]]
name = "worn"
output = "wear"
threshold = "6 um"
[life]
period = "100 ms"
cycles = 4000
checkpoint_every = 1000
[study]
population = 5000
initial = 10
batch = 2
max_evaluations = 16
accuracy = "draft"
[[variables]]
name = "load"
mean = 5
std = "5 %"
"""


def needs(*packages):
    missing = [package for package in packages if importlib.util.find_spec(package) is None]
    return unittest.skipIf(missing, f"no package {', '.join(missing)}")


def coordinator(*arguments, folder=None, python=sys.executable):
    """Output of a command of the coordinator, with this Python as python3."""
    program = os.environ.get("HINGEWISE_COORDINATOR", "coordinator")
    with tempfile.TemporaryDirectory() as bin_folder:
        # A link would lose the packages of a virtual environment.
        script = Path(bin_folder) / "python3"
        script.write_text(f'#!/bin/sh\nexec "{python}" "$@"\n')
        script.chmod(0o755)
        environment = {**os.environ, "PATH": f"{bin_folder}:{os.environ['PATH']}", "PYTHONPATH": str(PACKAGE)}
        done = subprocess.run([program, *arguments], capture_output=True, text=True, cwd=folder, env=environment)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout


class FourBar(unittest.TestCase):
    def largest_wear(self, scene, *more):
        text = coordinator("simulate", "--scene", str(scene), "--set", "load_torque=-0.82N*m", *more)
        return json.loads(text)["max_wear_depth_m"]

    def check(self, name):
        """Reactions of ideal joints wear like the joints with clearance, to the 2 % that friction and contact damping make."""
        found = self.largest_wear(EXAMPLE / f"{name}.toml")
        own = self.largest_wear("four-bar", "--accuracy", "draft")
        self.assertEqual(len(found), len(own))
        for depth, expected in zip(found[1:], own[1:]):
            self.assertLess(abs(depth / expected - 1), 0.03, (found, own))

    @needs("mujoco")
    def test_mujoco(self):
        self.check("mujoco")

    @needs("exudyn")
    def test_exudyn(self):
        self.check("exudyn")

    @needs("mujoco", "exudyn")
    def test_two_programs_have_one_motion(self):
        import exudyn_cycle
        import mujoco_cycle

        request = {"period": 1 / 15, "sample": {"load_torque": -0.8}}
        first, second = mujoco_cycle.cycle(request), exudyn_cycle.cycle(request)
        for name, joint in first["joints"].items():
            other = second["joints"][name]
            largest = max(map(abs, other["force_x"]))
            for k in range(0, 500, 25):
                # 500 instants of 2000 steps, and 1000.
                self.assertAlmostEqual(first["time"][k], second["time"][2 * k], places=9)
                for axis in ("force_x", "force_y"):
                    self.assertLess(abs(joint[axis][k] - other[axis][2 * k]), 1e-3 * largest, (name, axis, k))
                self.assertLess(abs(joint["angle"][k] - other["angle"][2 * k]), 1e-4)


class FmuStudy(unittest.TestCase):
    @needs("fmpy", "pythonfmu")
    def test_an_fmu_to_its_reliability(self):
        with tempfile.TemporaryDirectory() as folder:
            source = shutil.copy(PACKAGE / "tests" / "fmu" / "slider_crank.py", folder)
            build = [sys.executable, "-m", "pythonfmu", "build", "-f", source]
            subprocess.run(build, cwd=folder, check=True, capture_output=True)
            scene = Path(folder) / "fmu.toml"
            scene.write_text(FMU_SCENE.replace("PYTHON", json.dumps(sys.executable)))
            one = json.loads(coordinator("simulate", "--scene", str(scene), folder=folder))
            depths = one["wear_m"]
            self.assertEqual(depths, sorted(depths))
            self.assertGreater(depths[0], 0)
            # Twice the load is about twice the force on the pin, and with it twice the work.
            heavy = json.loads(coordinator("simulate", "--scene", str(scene), "--set", "load=10", folder=folder))
            self.assertGreater(heavy["wear_m"][-1], 1.1 * depths[-1])
            coordinator("run", "--scene", str(scene), "--out", "study", "--quiet", folder=folder)
            summary = json.loads((Path(folder) / "study" / "summary.json").read_text())
            self.assertEqual(len(summary["reliability"]), 4)


if __name__ == "__main__":
    unittest.main()
