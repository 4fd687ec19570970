"""The four-bar in programs of other authors. Run by `tests/tests/packages.rs`; a test is skipped by the names of the packages that are
missing."""

import importlib.util
import sys
import unittest
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLE = PACKAGE / "examples" / "four-bar"
sys.path[:0] = [str(PACKAGE), str(EXAMPLE)]

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


if __name__ == "__main__":
    unittest.main()
