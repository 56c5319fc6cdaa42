#!/usr/bin/env python3
"""The swarm repeats itself, finds the bugs that are planted, and keeps the contract of its command line.

Usage: tests/swarm/swarm_test.py --bin DIR [Swarm.test_...]
"""

import argparse
import json
import pathlib
import subprocess
import sys
import unittest

OPTIONS = None
# A planted bug must be found within so many seeds.
SEEDS_TO_FIND = 100


def run(*arguments):
    return subprocess.run([OPTIONS.bin / "lockwind-swarm", *map(str, arguments)], capture_output=True,
                          text=True, timeout=280, check=False)


def last_error(done):
    return [line for line in done.stderr.splitlines() if line.startswith("error:")][-1]


class Swarm(unittest.TestCase):
    def report(self, code, *arguments):
        done = run("--json", *arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def expect_found(self, plant):
        """By the first seed that finds it, which then finds it again, in the same way."""
        options = ["--plant", plant]
        found = run("--json", "--seeds", SEEDS_TO_FIND, *options)
        self.assertEqual(found.returncode, 1, found.stdout + found.stderr)
        report = json.loads(found.stdout)
        seed = report["first_failing_seed"]
        self.assertEqual(report["failures"], 1)
        self.assertLessEqual(seed, SEEDS_TO_FIND)
        words = f"lockwind-swarm --first {seed} --seeds 1 --plant {plant}"
        errors = [line for line in found.stderr.splitlines() if line.endswith(words)]
        self.assertEqual(len(errors), 1, found.stderr)
        again = run("--first", seed, "--seeds", 1, *options)
        self.assertEqual((again.returncode, last_error(again)), (1, errors[0]))
        healthy = run("--first", seed, "--seeds", 1)
        self.assertEqual(healthy.returncode, 0, healthy.stderr)
        print(f"{plant}: found at seed {seed}: {errors[0]}", file=sys.stderr)

    def test_finds_unconfirmed_hash(self):
        self.expect_found("unconfirmed_hash")

    def test_finds_reordered_input(self):
        self.expect_found("reordered_input")

    def test_finds_missing_field(self):
        self.expect_found("missing_field")

    def test_repeats_itself(self):
        one_by_one = self.report(0, "--first", 7, "--seeds", 4, "--jobs", 1)
        together = self.report(0, "--first", 7, "--seeds", 4, "--jobs", 4)
        self.assertEqual(one_by_one, together)
        others = self.report(0, "--first", 11, "--seeds", 4)
        self.assertNotEqual(others["digest"], together["digest"])

    def test_shows_the_same_timeline_again(self):
        first, second = (run("--first", 5, "--seeds", 1, "--verbose") for _ in range(2))
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertIn("fault: ", first.stderr)
        self.assertIn("healed", first.stderr)
        self.assertEqual((first.stdout, first.stderr), (second.stdout, second.stderr))
        # The match does not depend on the process that it is played in.
        self.assertEqual(run("--first", 5, "--seeds", 1).stdout, first.stdout)

    def test_refuses_wrong_usage(self):
        for arguments in (["--ticks", "10"], ["--seeds", "0"], ["--jobs", "0"], ["--mode", "rollback"],
                          ["--plant", "no_such_bug"], ["--verbose", "--seeds", "2"], ["nonsense"]):
            done = run(*arguments)
            self.assertEqual((done.returncode, done.stdout), (2, ""), (arguments, done.stderr))
            self.assertIn("error: ", done.stderr)
        self.assertEqual(run("--scene", "no/such/file").returncode, 3)

    def test_has_help_and_version(self):
        help_text = run("--help").stdout
        for flag in "seeds first ticks mode scene jobs plant verbose json".split():
            self.assertIn(f"--{flag}", help_text)
        self.assertIn("sim_version", run("--version").stdout)


def main():
    global OPTIONS
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of lockwind-swarm")
    OPTIONS, rest = parser.parse_known_args()
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
