"""Tests of the Python package with the real program: `python3 -m unittest discover deploy/python/tests`.

They need `coordinator` (HINGEWISE_COORDINATOR, or on the search path); tests of frames need pandas and say if it is missing.
"""

import copy
import datetime
import json
import math
import os
import sqlite3
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import hingewise
from hingewise.study import TABLES

try:
    import pandas
except ImportError:
    pandas = None

SCENES = Path(__file__).resolve().parents[3] / "common/scenes"


def small(evaluations=16):
    """The four-bar with few evaluations."""
    scene = hingewise.load_scene("four-bar")
    scene["study"] |= {"population": 2000, "initial": 12, "batch": 4, "max_evaluations": evaluations}
    return scene


class WithStudy(unittest.TestCase):
    """Tests of one small study, which is run once."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.addClassCleanup(os.chdir, os.getcwd())
        os.chdir(cls.folder.name)
        cls.progress = []
        cls.study = hingewise.run(
            small(), "study", levels="draft", workers=2, progress=cls.progress.append
        )

    def test_progress_counts_up_to_the_whole_study(self):
        counted = [line for line in self.progress if line.done is not None]
        self.assertGreater(len(counted), 0)
        self.assertTrue(all(0 <= line.done <= line.most == 16 for line in counted), counted)
        self.assertTrue(any("round" in str(line) for line in self.progress), self.progress)
        self.assertEqual(list(Path(".").glob(".hingewise-*")), [])

    def test_the_scene_is_the_one_that_was_run(self):
        self.assertEqual(self.study.scene, small())

    def test_rows_have_the_values_of_the_files(self):
        study = self.study
        self.assertEqual(study.summary, json.loads(Path("study/summary.json").read_text()))
        cycles = [row["cycles"] for row in study.summary["reliability"]]
        for table in ("reliability", "moments"):
            self.assertEqual([row["cycles"] for row in study.rows(table)], cycles, table)
        for row, stated in zip(study.rows("reliability"), study.summary["reliability"], strict=True):
            self.assertTrue(math.isclose(row["R_total"], stated["total"], abs_tol=1e-12))
            self.assertTrue(math.isclose(row["low_total"], stated["interval"]["total"]["lower"], abs_tol=1e-12))
        lives = {(row["limit_state"], row["level"]): row for row in study.rows("lives")}
        self.assertEqual({level for _, level in lives}, {0.99, 0.9, 0.5})
        half = lives["total", 0.5]
        self.assertTrue(half["interval_lower"] <= half["cycles"] <= half["interval_upper"])
        sensitivities = study.rows("sensitivities")
        variables = {row["name"] for row in study.rows("variables")}
        states = study.summary["limit_states"]
        self.assertEqual({row["variable"] for row in sensitivities}, variables)
        self.assertEqual({row["limit_state"] for row in sensitivities}, {*states, "total"})
        first = study.summary["sensitivity"][0]
        self.assertEqual(sensitivities[0]["standard_error_d_pf_d_mean"], first["standard_error"]["d_pf_d_mean"])
        self.assertEqual([row["name"] for row in study.rows("limits")], states)

    def test_samples_and_outputs_belong_together(self):
        samples, outputs = self.study.rows("samples"), self.study.rows("outputs")
        self.assertEqual(len(samples), self.study.summary["evaluations"]["total"])
        self.assertEqual(len(samples), 16)
        variables = [row["name"] for row in self.study.rows("variables")]
        self.assertTrue(all(isinstance(row[name], (int, float)) for row in samples for name in variables))
        self.assertIsNone(samples[0]["failure"])
        self.assertEqual({row["evaluation"] for row in outputs}, {row["id"] for row in samples})
        # The same value by another way: the exact file through SQL.
        with sqlite3.connect("study/campaign.db") as database:
            (friction,) = database.execute("SELECT friction FROM input WHERE evaluation = 3").fetchone()
        self.assertEqual(samples[3]["friction"], friction)
        errors = self.study.rows("output_errors")
        self.assertEqual(errors[0].keys(), outputs[0].keys())
        self.assertGreater(errors[-1]["max_wear_depth"], 0)

    @unittest.skipIf(pandas is None, "pandas is not installed")
    def test_frames_are_the_rows_by_their_index(self):
        self.assertEqual(self.study.rows("levels"), [])
        with_levels = hingewise.Study("study")
        with_levels.summary["levels"] = {"differences": [{"limit_state": "wear", "order": 2.0}]}
        for table, index in TABLES.items():
            study = with_levels if table == "levels" else self.study
            frame, rows = getattr(study, table), study.rows(table)
            self.assertEqual(len(frame), len(rows), table)
            self.assertGreater(len(rows), 0, table)
            self.assertEqual(list(frame.index.names), index, table)
            self.assertTrue(frame.index.is_unique, table)
        reliability = self.study.reliability["R_total"]
        self.assertTrue(reliability.is_monotonic_decreasing and reliability.between(0, 1).all())
        ratio = self.study.in_units("outputs")["max_wear_depth [µm]"] / self.study.outputs["max_wear_depth"]
        self.assertTrue(((ratio - 1e6).abs() < 1e-3).all(), ratio)
        self.assertIn("clearance_crank [um]", self.study.in_units("samples"))
        wear = self.study.outputs["max_wear_depth"].unstack("cycles")
        self.assertEqual(wear.shape, (16, len(reliability)))
        with self.assertRaises(AttributeError):
            self.study.nonsense

    def test_questions_to_a_study_are_the_commands(self):
        changed = hingewise.what_if(self.study, {"wear.threshold": "9 um"})
        same = hingewise.call("what-if", "study", "--set", "wear.threshold=9 um")
        self.assertEqual(changed["lives"], same["lives"])
        lives = changed.frame("lives") if pandas else changed["lives"]
        self.assertEqual(len(lives), 6)
        row = ("A7", 2000, "max_wear_depth", "3.7 um", "0.1 um")
        unit = hingewise.update("study", [row], points=4000)["units"][0]
        self.assertEqual((unit["unit"], unit["observed_until"]), ("A7", 2000))
        with self.assertRaises(hingewise.ProgramError) as raised:
            hingewise.learn(self.study, [("A7", 2000, "nonsense", 1, 1)])
        self.assertIn("nonsense", str(raised.exception))
        named = dict(zip(("unit", "cycles", "quantity", "value", "error"), row))
        survived = {"unit": "A7", "cycles": 2000, "quantity": "survived"}
        remaining = hingewise.update("study", [row, ("A7", 2000, "survived")], points=4000)["units"][0]["remaining"]
        tables = [[named, survived]] + ([pandas.DataFrame([named, survived])] if pandas else [])
        for table in tables:
            self.assertEqual(hingewise.update("study", table, points=4000)["units"][0]["remaining"], remaining)
        with self.assertRaisesRegex(KeyError, "eror: the columns are unit, cycles, quantity"):
            hingewise.update("study", [named | {"eror": 1}])
        with self.assertRaises(hingewise.ProgramError) as raised:
            hingewise.update("study", [named | {"quantity": "nonsense"}])
        self.assertIn(" rows:2:", str(raised.exception))
        problem = {
            "quantities": [{"change": "friction.mean", "lower": 0.04, "upper": 0.05, "cost": {"model": "linear", "c0": 0, "c1": 1}}],
            "targets": [{"reliability": 0.5, "cycles": 5000}],
        }
        replaced = hingewise.replace(self.study, 10)
        self.assertEqual(replaced["evaluations"], 0)
        self.assertEqual(hingewise.replace(self.study, 10, out="replaced.json"), replaced)
        units = [("A", 5000, "failed"), ("B", 6000, "failed"), ("C", 4000, "running")]
        alone = hingewise.weibull(units)
        self.assertNotEqual(alone, hingewise.weibull(units, self.study))
        self.assertEqual(alone, hingewise.weibull([dict(zip(("cycles", "unit", "state"), (n, u, s))) for u, n, s in units]))
        # ln(1 - 0.9) / ln 0.99 units without failure.
        self.assertEqual(hingewise.test_plan(0.99, 5000)["plans"][0]["units"], 230)
        found = hingewise.optimise(self.study, problem, max_evaluations=0)
        self.assertTrue(0.04 <= found["optimum"]["cost"] <= 0.05, found["optimum"])

    def test_a_notebook_shows_the_lives_and_the_curve(self):
        page = self.study._repr_html_()
        self.assertIn("16 simulations", page)
        self.assertEqual(page.count("<tr>"), 1 + len(self.study.rows("lives")))
        self.assertEqual(self.study.units["max_wear_depth"], "m")
        self.assertEqual(self.study.units["coupler_joint_speed"], "rad/s")
        curves = self.study.rows("curves")
        self.assertTrue(all(row["lower"] <= row["reliability"] <= row["upper"] for row in curves))
        try:
            import matplotlib
        except ImportError:
            return
        matplotlib.use("agg")
        self.assertEqual(len(self.study.plot(limit_states=["total"]).lines), 1)
        with self.assertRaisesRegex(KeyError, "waer: the limit states are wear, total"):
            self.study.plot(limit_states=["waer"])

    def test_issue_a_notebook_showed_bounds_as_half_an_interval(self):
        seen = copy.copy(self.study)
        seen.summary = copy.deepcopy(self.study.summary)
        for life, (cycles, lower, upper) in zip(
            seen.summary["lives"], [(None, 8000.0, None), (None, 0.0, 5.0), (None, 0.0, None), (27.9012, 27.5896, 28.2551)], strict=False
        ):
            life |= {"cycles": cycles, "interval": {"lower": lower, "upper": upper}}
        page = seen._repr_html_()
        for shown in ("<td>beyond 8 000</td><td></td>", "<td>before 5</td>", "<td>not known</td>", "<td>27.9</td><td>27.59 to 28.26</td>"):
            self.assertIn(shown, page)
        only = seen.summary["reliability"][4]
        seen.summary |= {"lives": [], "curves": [], "reliability": [only]}
        self.assertIn(f"<td>total</td><td>{only['total']:.6g}</td>", seen._repr_html_())
        with self.assertRaisesRegex(hingewise.StudyError, "one checkpoint"):
            seen.plot()

    def test_own_samples_are_simulated_in_their_order(self):
        rows = [{"friction": 0.04}, {"no_variable": 1}, {"friction": 0.06, "parameters.width": "11 mm"}, {"friction": -1}]
        first, second, third, fourth = hingewise.evaluate(small(), rows, accuracy="draft", at_once=2)
        for wrong in (second, fourth):
            self.assertIsInstance(wrong, hingewise.ProgramError)
            self.assertNotIn(".hingewise-", str(wrong))
        alone = hingewise.simulate("four-bar", {"friction": 0.04}, accuracy="draft", out="one.json")
        self.assertEqual(first["max_wear_depth_m"], alone["max_wear_depth_m"])
        self.assertLess(third["max_wear_depth_m"][-1], first["max_wear_depth_m"][-1])
        self.assertTrue(hingewise.check("four-bar", quick=True)["valid"])
        wrong = small() | {"life": {}}
        found = hingewise.check(wrong, quick=True)
        self.assertFalse(found["valid"])
        self.assertEqual([(fault["file"], fault["key"]) for fault in found["faults"]][0], ("scene", "life.cycles"))

    def test_a_study_goes_on_and_nothing_is_run_again(self):
        before = {row["id"]: row["finished_at"] for row in self.study.rows("samples")}
        hingewise.run("study/scene.toml", "longer", levels="draft", workers=2, set={"friction": 0.05})
        longer = hingewise.resume("longer", max_evaluations=18, workers=2)
        self.assertEqual(longer.summary["evaluations"]["total"], 18)
        self.assertEqual(len(longer.rows("samples")), 18)
        again = hingewise.resume("study")
        self.assertEqual({row["id"]: row["finished_at"] for row in again.rows("samples")}, before)

    def test_faults_are_those_of_the_program(self):
        wrong = small()
        wrong["study"]["seed"] = "one"
        with self.assertRaises(hingewise.ProgramError) as raised:
            hingewise.run(wrong, "wrong", workers=1)
        self.assertEqual(raised.exception.code, 2)
        self.assertIn("seed", str(raised.exception))
        self.assertFalse(Path("wrong").exists())
        with self.assertRaises(hingewise.ProgramError) as raised:
            hingewise.run("four-bar", "study")
        self.assertIn("already holds a study", str(raised.exception))

    def test_issue_a_study_hid_that_its_targets_were_not_met(self):
        self.assertFalse(self.study.targets_met)
        with self.assertWarns(hingewise.StudyWarning) as warned:
            again = hingewise.resume("study")
        stopped = again.summary["convergence"]["stopped_because"]
        self.assertIn("points beyond 30 simulations", stopped)
        self.assertIn(stopped, again.ending)
        self.assertIn(stopped, str(warned.warning))
        self.assertIn(f"stopped because {stopped}", again.printed)
        self.assertIsNone(hingewise.Study("study").printed)

    def test_issue_a_message_named_a_temporary_file(self):
        wrong = small()
        wrong["bodies"][1]["mass"] = "3 kgg"
        for options in ({}, {"progress": lambda line: None}):
            with self.assertRaises(hingewise.ProgramError) as raised:
                hingewise.run(wrong, "wrong", workers=1, **options)
            said = str(raised.exception)
            self.assertIn("scene:", said)
            self.assertNotIn(".hingewise-", said)
            self.assertNotIn(os.getcwd(), said)

    def test_an_interruption_stops_the_study_without_loss(self):
        def interrupt(line):
            if line.done:
                raise KeyboardInterrupt

        scene = small(60)
        scene["study"]["initial"] = 40
        with self.assertRaises(KeyboardInterrupt):
            hingewise.run(scene, "stopped", accuracy="draft", workers=1, progress=interrupt)
        with self.assertRaises(hingewise.StudyError) as raised:
            hingewise.Study("stopped")
        self.assertIn("coordinator resume stopped", str(raised.exception))
        self.assertEqual(hingewise.call("status", "stopped")["state"], "interrupted")

    def test_a_later_form_is_refused(self):
        later = dict(self.study.summary, schema=99)
        Path("later").mkdir()
        Path("later/summary.json").write_text(json.dumps(later))
        with self.assertRaises(hingewise.StudyError) as raised:
            hingewise.Study("later")
        self.assertIn("schema 99, this package reads 1", str(raised.exception))


class ElsewhereTest(unittest.TestCase):
    """Scenes from another folder than the current one."""

    CARD = "crank [deg],torque [N m]\n0,{0}\n180,{1}\n360,{0}\n"

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        Path("sub").mkdir()
        Path("sub/card.csv").write_text(self.CARD.format("-0.8", "-0.7"))
        Path("card.csv").write_text(self.CARD.format("-8", "-7"))
        scene = hingewise.load_scene("four-bar")
        scene["loads"] = [
            {"name": "card", "type": "torque", "body": "rocker", "torque": {"over": {"angle": "crank"}, "csv": "card.csv"}}
        ]
        scene["variables"] = [row for row in scene["variables"] if row["name"] != "load_torque"]
        scene["scene"]["name"] = "base"
        Path("sub/base.toml").write_text(hingewise.dumps(scene))
        Path("base.toml").write_text(hingewise.dumps(scene | {"life": {"cycles": 1, "checkpoint_every": 1}}))
        Path("sub/own.toml").write_text('[scene]\nname = "own"\nextends = "base.toml"\n')
        Path("sub/four.toml").write_text('[scene]\nname = "four"\nextends = "four-bar"\n')

    def simulated(self, file):
        return hingewise.call("simulate", file, "--accuracy", "draft")["max_wear_depth_m"]

    def test_issue_a_scene_of_another_folder_took_files_of_this_one(self):
        for name in ("base", "own"):
            expected = self.simulated(f"sub/{name}.toml")
            hingewise.save_scene(hingewise.load_scene(f"sub/{name}.toml"), "moved.toml")
            self.assertEqual(self.simulated("moved.toml"), expected, name)
        self.assertNotEqual(self.simulated("base.toml"), expected)
        # The name of a built-in scene stays one.
        self.assertEqual(hingewise.load_scene("sub/four.toml")["scene"]["extends"], "four-bar")

    def test_issue_a_program_was_started_in_another_folder(self):
        for named in ('program = ["python3", "beam.py"]', 'fmu = "beam.fmu"'):
            Path("sub/beam.toml").write_text(f"[simulator]\n{named}\n")
            self.assertEqual(hingewise.load_scene("sub/beam.toml")["simulator"]["folder"], str(Path.cwd() / "sub"))


class Scenes(unittest.TestCase):
    """Scenes as dictionaries."""

    def test_every_scene_is_the_same_after_writing_it(self):
        files = sorted(SCENES.glob("*.toml"))
        self.assertGreater(len(files), 5)
        for file in files:
            scene = tomllib.loads(file.read_text(encoding="utf-8"))
            # The text of a dictionary also tells whole numbers from others.
            self.assertEqual(repr(tomllib.loads(hingewise.dumps(scene))), repr(_values_first(scene)), file.name)

    def test_a_written_scene_is_simulated_to_the_same_bits(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "scene.toml")
            hingewise.save_scene(hingewise.load_scene("four-bar"), file)
            self.assertEqual(hingewise.load_scene(file), hingewise.load_scene("four-bar"))
            results = [hingewise.call("simulate", s, "--accuracy", "draft") for s in (file, "four-bar")]
        for result in results:
            del result["wall_s"]
        self.assertEqual(*results)

    def test_values_of_every_kind_are_written(self):
        table = {
            "text": 'a "quote" \\ back\nslash, tab\t, é, \x7f',
            "numbers": [1, -2, 1e300, 0.1, 1e-7, 5.0, math.inf, -math.inf],
            "truth": [True, False],
            "date": datetime.date(2026, 1, 2),
            "odd key.": {"empty": {}, "list": []},
            "tables": [{"a": 1, "inner": {"b": [{"c": 2}]}}, {"a": 3}],
            "mixed": [1, {"a": [2]}],
        }
        self.assertEqual(repr(tomllib.loads(hingewise.dumps(table))), repr(_values_first(copy.deepcopy(table))))
        self.assertIn("nan", hingewise.dumps({"x": math.nan}))
        for wrong in ({"x": None}, {"x": {1}}, {1: 2}):
            with self.assertRaises(TypeError):
                hingewise.dumps(wrong)

    def test_an_unknown_scene_is_refused(self):
        with self.assertRaises(hingewise.ProgramError) as raised:
            hingewise.load_scene("no-such-scene")
        self.assertEqual(raised.exception.code, 2)


def _values_first(table):
    """The order that TOML can write: values before tables."""
    if not isinstance(table, dict):
        return table

    def is_table(value):
        return isinstance(value, dict) or bool(
            isinstance(value, list) and value and all(isinstance(entry, dict) for entry in value)
        )

    ordered = sorted(table.items(), key=lambda item: is_table(item[1]))
    return {
        key: _values_first(value) if isinstance(value, dict)
        else [_values_first(entry) for entry in value] if is_table(value) else value
        for key, value in ordered
    }


if __name__ == "__main__":
    unittest.main()
