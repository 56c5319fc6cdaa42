#!/usr/bin/env python3
"""tests/bench/report measures what it says, and refuses measurements that do not belong together.

Usage: tests/bench/report_test.py --build DIR [Report.test_...]
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

from reporting import measure, results

HERE = pathlib.Path(__file__).resolve().parent
OPTIONS = None
# Runs the true program, on step/pyramid_210 alone, and calls one engine's state another.
LIAR = """#!/usr/bin/env python3
import pathlib, subprocess, sys
if "--benchmark_list_tests=true" in sys.argv:
    print("step/pyramid_210/lockwind\\nstep/pyramid_210/lockwind_scalar\\nstep/pyramid_210/bullet")
    sys.exit()
subprocess.run([{program!r}, *sys.argv[1:]], check=True, stdout=subprocess.DEVNULL)
out = pathlib.Path([flag for flag in sys.argv if flag.startswith("--benchmark_out=")][0].split("=")[1])
lines = out.read_text().splitlines()
at = max(index for index, line in enumerate(lines) if "state_hash=" in line)
lines[at] = '"label": "state_hash=0123456789abcdef"'
out.write_text("\\n".join(lines))
"""


def report(*arguments):
    return subprocess.run([HERE / "report", *map(str, arguments)], capture_output=True, text=True, timeout=280,
                          check=False)


def row(time_us, **more):
    """As lockwind-bench tells it; the clock that does not count says nonsense."""
    return {"time_unit": "ms", "real_time": time_us / 1000, "cpu_time": 12345.0, **more}


class Figures(unittest.TestCase):
    """Of invented measurements, whose results are known."""

    def test_compares_what_ran_in_the_same_pass(self):
        # The first pass has no Bullet, and in the third the machine was ten times slower.
        runs = results.Runs([{"step/a/lockwind": row(30)},
                             {"step/a/lockwind": row(10), "step/a/bullet": row(40)},
                             {"step/a/lockwind": row(200), "step/a/bullet": row(400)}])
        self.assertEqual(runs.ratios("step/a/lockwind", "step/a/bullet"), [0.25, 0.5])
        self.assertAlmostEqual(runs.median_us("step/a/lockwind"), 30)

    def test_counts_processor_time_of_what_does_not_time_itself(self):
        runs = results.Runs([{"save/a": {"time_unit": "ns", "real_time": 9e9, "cpu_time": 1500.0}}])
        self.assertEqual(runs.times_us("save/a"), [1.5])

    def test_takes_one_state_hash_only(self):
        label = {"label": "state_hash=00000000000000aa"}
        runs = results.Runs([{"step/a/lockwind": row(1, **label), "step/a/lockwind_avx2": row(1, **label)}])
        self.assertEqual(results.state_hash(runs, "a", ["lockwind", "lockwind_avx2"]), "00000000000000aa")
        for other in ("state_hash=00000000000000ab", "state_hash=", ""):
            again = results.Runs([*runs.passes, {"step/a/lockwind_avx2": row(1, label=other)}])
            with self.assertRaises(measure.BenchError):
                results.state_hash(again, "a", ["lockwind", "lockwind_avx2"])

    def test_snapshots_are_told_by_what_they_cannot_beat(self):
        times = {"save/a": 30, "load/a": 90, "keep/a": 12, "restore/a": 8, "memcpy/a": 10, "hash/a": 3,
                 "xxh3/a": 2}
        told = results.snapshots(results.Runs([
            {name: {"time_unit": "us", "real_time": 0, "cpu_time": us, "bodies": 5, "snapshot_bytes": 1000}
             for name, us in times.items()}]))["a"]
        self.assertAlmostEqual(told["keep_over_memcpy"], 1.2)
        self.assertAlmostEqual(told["restore_over_memcpy"], 0.8)
        self.assertAlmostEqual(told["hash_over_xxh3"], 1.5)
        self.assertEqual(told["bytes_per_body"], 200)

    def test_growth_is_time_a_body(self):
        times = {"growth/separate_10": 10, "growth/separate_100": 200, "growth/resting_awake_100": 50,
                 "growth/resting_asleep_100": 2}
        passes = [{name: {"time_unit": "us", "real_time": 0, "cpu_time": us} for name, us in times.items()}]
        passes[0].update({"step/heap_10/lockwind": row(10), "step/heap_80/lockwind": row(120)})
        told = results.growth(results.Runs(passes))
        self.assertAlmostEqual(told["separate_per_body"], 2)
        self.assertAlmostEqual(told["heap_per_body"], 1.5)
        self.assertEqual(told["heap_bodies"], [10, 80])
        self.assertAlmostEqual(told["asleep_over_awake"], 0.04)
        self.assertIsNone(told["resting_awake_per_body"])


class Report(unittest.TestCase):
    """Of true measurements, of which only that is known which holds on every machine."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="lockwind-report-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_quick_run_tells_everything(self):
        done = report("--quick", "--build", OPTIONS.build, "--out", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads((self.folder / "results.json").read_text())
        self.assertEqual(set(told), {"machine", "settings", "scenes", "phases", "snapshots", "rollback", "growth",
                                     "runs_us", "replay"})
        for key in ("cpu", "caches", "compiler", "flags", "sim_version", "commit"):
            self.assertTrue(told["machine"][key] or key == "caches", key)
        self.expect_steps(told["scenes"]["pyramid_210"])
        self.expect_costs(told)
        self.expect_growth(told["growth"])
        for runs in told["runs_us"].values():
            self.assertEqual(len(runs), 2)
            self.assertGreater(min(runs), 0)
        page = (self.folder / "report.html").read_text()
        self.assertEqual(page.count("<svg"), 6)
        self.assertNotIn("<script", page)
        self.assertNotIn("<img", page)
        rows = (self.folder / "table.md").read_text().splitlines()
        self.assertEqual(rows[0].count("|"), rows[2].count("|"))
        self.assertTrue(rows[2].startswith("| `pyramid_210` | 0."), rows)

    def expect_steps(self, scene):
        self.assertRegex(scene["state_hash"], "^[0-9a-f]{16}$")
        self.assertLessEqual({"lockwind", "lockwind_scalar", "bullet"}, set(scene["engines"]))
        for name, engine in scene["engines"].items():
            self.assertGreater(engine["p50_us"], 0, name)
            self.assertGreaterEqual(engine["p99_us"], engine["p50_us"], name)
            self.assertGreaterEqual(engine["p99_over_p50"], 1, name)
            self.assertEqual(engine["awake"], 210, name)
            self.assertGreater(engine["contacts"], 210, name)
            self.assertLessEqual(engine["to_bullet_low"], engine["to_bullet"], name)
            self.assertLessEqual(engine["to_bullet"], engine["to_bullet_high"], name)
        self.assertEqual(scene["engines"]["bullet"]["to_bullet"], 1)

    def expect_costs(self, told):
        phases = told["phases"]["pyramid_210"]
        self.assertAlmostEqual(sum(phases["shares"].values()), 1)
        self.assertGreater(phases["shares"]["solve"], phases["shares"]["next_tick"])
        snapshots = told["snapshots"]["pyramid_210"]
        self.assertEqual(snapshots["bodies"], 211)
        self.assertGreater(snapshots["bytes_per_body"], 100)
        # A load checks and makes anew what a restore only copies; the floors are no ceilings.
        self.assertGreater(snapshots["load_us"], snapshots["restore_us"])
        for key in ("keep_over_memcpy", "hash_over_xxh3"):
            self.assertGreater(snapshots[key], 0, key)
        self.assertLessEqual({"boxes_200", "boxes_200_resting"}, set(told["rollback"]))
        for name, rollback in told["rollback"].items():
            # Nine steps, and what saving, hashing and restoring cost.
            self.assertGreater(rollback["steps"], 7, name)
            self.assertLess(rollback["steps"], 30, name)
            self.assertGreater(rollback["contacts"], 0, name)

    def expect_growth(self, growth):
        for curve in ("separate", "resting_awake", "resting_asleep"):
            self.assertEqual(growth[f"{curve}_bodies"], [1000, 10000])
        self.assertLess(growth["separate_per_body"], 4)
        self.assertLess(growth["asleep_over_awake"], 0.2)
        self.assertEqual(growth["heap_bodies"], [1000, 1000])

    def test_hash_that_differs_fails(self):
        program = self.folder / "bin/lockwind-bench"
        program.parent.mkdir()
        program.write_text(LIAR.format(program=str(OPTIONS.build / "bin/lockwind-bench")))
        program.chmod(0o755)
        done = report("--quick", "--build", self.folder)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, "pyramid_210 does not end in one state: 0123456789abcdef by lockwind_scalar; ")
        self.assertFalse((self.folder / "bench").exists())

    def test_refuses_wrong_usage(self):
        for arguments in (["--build", self.folder], ["--repetitions", "0"], ["nonsense"]):
            done = report(*arguments)
            self.assertEqual((done.returncode, done.stdout), (2, ""), arguments)
            self.assertIn("error: ", done.stderr)


def main():
    global OPTIONS
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, required=True, help="where lockwind-bench was built")
    OPTIONS, rest = parser.parse_known_args()
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
