"""The four-bar in programs of other authors. Run by `tests/tests/packages.rs`; a test is skipped by the names of the packages that are
missing."""

import importlib.util
import math
import sys
import unittest
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLE = PACKAGE / "examples" / "four-bar"
sys.path[:0] = [str(PACKAGE), str(EXAMPLE), str(EXAMPLE.parent)]

def needs(*packages):
    missing = [package for package in packages if importlib.util.find_spec(package) is None]
    return unittest.skipIf(missing, f"no package {', '.join(missing)}")


class FourBar(unittest.TestCase):
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

    @needs("exudyn")
    def test_contacts_on_worn_bores_turn_with_the_ideal_joints(self):
        import compare
        import exudyn_cycle

        request = compare.request({"load_torque": -0.8}, ("crank", "coupler", "rocker"), compare.worn(4.03e-3), 4e-3)
        ideal, worn = exudyn_cycle.cycle(request), exudyn_cycle.contact_cycle(request)
        for name, joint in worn["joints"].items():
            other = ideal["joints"][name]
            column = compare.Column(ideal["time"], other["angle"])
            rows = zip(worn["time"], joint["angle"])
            off = max(abs(math.remainder(angle - column.at(t), math.tau)) for t, angle in rows)
            # The largest play, 36 um, over the shortest body, 20 mm.
            self.assertLess(off, 4 * 36e-6 / 20e-3)
            largest, here = (max(map(math.hypot, of["force_x"], of["force_y"])) for of in (other, joint))
            self.assertLess(abs(here / largest - 1), 0.02, name)
            # The journal touches where it presses.
            for x, y, fx, fy in zip(*(joint[key] for key in ("eccentricity_x", "eccentricity_y", "force_x", "force_y"))):
                if math.hypot(fx, fy) > 0.1 * largest:
                    self.assertGreater(math.hypot(x, y), 29e-6)
                    self.assertLess(abs(x * fy - y * fx), 1e-9 * math.hypot(x, y) * math.hypot(fx, fy))

    @needs("exudyn")
    def test_a_thick_beam_has_the_motion_of_a_rigid_coupler(self):
        import exudyn_cycle
        import flexible_cycle

        def cycle(tool, **sample):
            return tool.cycle({"period": 1 / 15, "sample": {"load_torque": -0.8, **sample}})

        rigid, thick, thin = (
            cycle(exudyn_cycle),
            cycle(flexible_cycle, rod_thickness=20e-3),
            cycle(flexible_cycle, rod_thickness=1e-3),
        )
        for name, joint in rigid["joints"].items():
            for key, tolerance in ("force_x", 1e-3), ("force_y", 1e-3), ("angle", 1e-4):
                off = max(abs(a - b) for a, b in zip(joint[key], thick["joints"][name][key]))
                self.assertLess(off, tolerance, (name, key))
        # A beam bends in proportion to its compliance, here to the inverse square of its thickness.
        ratio = thin["outputs"]["deflection"] / thick["outputs"]["deflection"]
        self.assertLess(abs(ratio / 400 - 1), 0.02, ratio)


class Drive(unittest.TestCase):
    @needs("exudyn")
    def test_ideal_joints_have_the_published_range_and_forces(self):
        sys.path.insert(0, str(PACKAGE / "examples" / "drive"))
        import drive

        joints = drive.cycle(0.0, True)["joints"]
        # Angle of the frame minus that of the right rocker: Cui et al. (2026) print 29.570 and -29.742 degrees, 9.27 and 5.94 N.
        angles = [math.degrees(angle) for angle in joints["5"]["angle"]]
        self.assertLess(abs(max(angles) - 29.742), 5e-3)
        self.assertLess(abs(min(angles) + 29.570), 5e-3)
        for name, largest in ("1", 6.045), ("5", 9.277):
            forces = map(math.hypot, joints[name]["force_x"], joints[name]["force_y"])
            self.assertLess(abs(max(forces) / largest - 1), 1e-3)


if __name__ == "__main__":
    unittest.main()
