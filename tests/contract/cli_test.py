#!/usr/bin/env python3
"""The command line keeps its contract: help, versions, exit codes, JSON, and what the documents show.

Usage: tests/contract/cli_test.py --bin DIR
"""

import argparse
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SUBCOMMANDS = ["bots", "replay", "diff", "info", "scenes"]
COMMANDS = [["lockwind-server"], *[["lockwind", name] for name in SUBCOMMANDS]]
# What the programs promise, by command: flags that its --help must know.
FLAGS = {
    "lockwind-server": "scene mode players ticks tick-rate seed listen domain match input-delay window "
                       "join-timeout hash-interval desync log resume matches metrics json",
    "lockwind bots": "count server domain match behaviour seed net corrupt corrupt-phase json",
    "lockwind replay": "verify from to trace rerecord bisect json",
    "lockwind diff": "json junit",
    "lockwind info": "json export",
    "lockwind scenes": "check json",
}
OPTIONS = None


def run(*command):
    """The finished process of a program in the bin folder."""
    program, *arguments = map(str, command)
    return subprocess.run([OPTIONS.bin / program, *arguments], capture_output=True, text=True,
                          timeout=60, check=False)


class CommandLine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="lockwind-cli-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def expect_refused(self, code, words, *command):
        """Exits with `code`, says `words` in a few lines on stderr, nothing on stdout."""
        done = run(*command)
        self.assertEqual(done.returncode, code, f"{command}: {done.stdout}{done.stderr}")
        self.assertEqual(done.stdout, "", command)
        self.assertIn(words, done.stderr, command)
        self.assertLessEqual(len(done.stderr.strip().splitlines()), 3, done.stderr)

    def test_every_command_has_help_with_its_flags(self):
        for command in COMMANDS:
            done = run(*command, "--help")
            self.assertEqual(done.returncode, 0, command)
            for flag in FLAGS[" ".join(command)].split():
                self.assertRegex(done.stdout, rf"--{flag}\b", command)

    def test_every_program_has_a_version(self):
        for program in ("lockwind", "lockwind-server"):
            done = run(program, "--version")
            self.assertEqual(done.returncode, 0)
            self.assertRegex(done.stdout, r"sim_version [0-9a-f]{16}")

    def test_wrong_usage_exits_2(self):
        for command in (["bots"], ["replay", "x"], ["diff", "x"], ["info", "x"], ["scenes"]):
            self.expect_refused(2, "--no-such-flag", "lockwind", *command, "--no-such-flag")
        self.expect_refused(2, "--scene", "lockwind-server")
        self.expect_refused(2, "--no-such-flag", "lockwind-server", "--scene", "empty",
                            "--no-such-flag")
        self.expect_refused(2, "", "lockwind")
        self.expect_refused(2, "no command 'no-such-command'", "lockwind", "no-such-command")
        self.expect_refused(2, "FILE is required", "lockwind", "info", "--json")

    def test_numbers_are_whole_and_in_range(self):
        server = ["lockwind-server", "--scene", "empty"]
        for flag, value in (("players", "x"), ("players", "65"), ("seed", "-1"), ("ticks", "0"),
                            ("ticks", "1.5"), ("domain", "0"), ("tick-rate", "")):
            self.expect_refused(2, f"--{flag}: ", *server, f"--{flag}={value}")
        self.expect_refused(2, "--seed: '-1'", "lockwind", "bots", "--seed", "-1")

    def test_wrong_test_faults_are_refused_before_the_match(self):
        bots = ["lockwind", "bots"]
        self.expect_refused(2, "body.linear_velocity", *bots, "--corrupt", "slot=0,tick=9,field=body.typo")
        self.expect_refused(2, "--corrupt", *bots, "--corrupt=")
        self.expect_refused(2, "narrow_phase", *bots, "--corrupt-phase", "typo")
        self.expect_refused(2, "--net", *bots, "--net", "")

    def test_bots_that_find_no_server_say_where_they_looked(self):
        done = run("lockwind", "bots", "--domain", "97", "--match", "nowhere", "--json",
                   "--connect-timeout", "1")
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("no server was found of match 'nowhere' at 127.0.0.1, domain 97", done.stderr)
        self.assertIsNone(json.loads(done.stdout)["bots"][0]["slot"])

    def test_outputs_that_cannot_be_written_are_refused_before_the_work(self):
        scene = self.file("old", "precious")
        for command in (["replay", "--trace"], ["replay", "--snapshot"], ["info", "--export"],
                        ["diff", "--junit"]):
            name, flag = command
            nowhere = self.folder / "nowhere" / "x"
            self.expect_refused(3, f"{flag} {nowhere}: the folder", "lockwind", name, "a-file", flag,
                                nowhere)
            if flag != "--junit":
                self.expect_refused(2, f"{flag} {scene}: the file exists", "lockwind", name, "a-file",
                                    flag, scene)
        self.assertEqual(scene.read_text(encoding="utf-8"), "precious")

    def test_missing_files_exit_3(self):
        missing = self.folder / "missing"
        for command in (["replay", missing], ["info", missing], ["diff", missing],
                        ["scenes", "--check", missing]):
            done = run("lockwind", *command)
            self.assertEqual(done.returncode, 3, f"{command}: {done.stderr}")
            self.assertIn(str(missing), done.stderr)

    def test_an_existing_log_is_never_overwritten(self):
        log = self.file("old.log", "precious")
        self.expect_refused(2, str(log), "lockwind-server", "--scene", "empty", "--log", log)
        self.assertEqual(log.read_text(encoding="utf-8"), "precious")

    def test_what_is_not_there_yet_exits_2_and_says_so(self):
        server = ["lockwind-server", "--scene", "empty", "--log", self.folder / "x.log"]
        for flags in (["--mode", "rollback"], ["--mode", "snapshot"], ["--desync", "resync"],
                      ["--desync", "kick"], ["--resume", ""], ["--matches", "1"],
                      ["--metrics", "0"], ["--window", "0"]):
            self.expect_refused(2, flags[0].lstrip("-"), *server, *flags)

    def test_scenes_lists_and_checks_as_json(self):
        listed = json.loads(run("lockwind", "scenes", "--json").stdout)
        names = {scene["name"]: scene for scene in listed["scenes"]}
        self.assertGreaterEqual(names["arena"]["bodies_dynamic"], 200)
        self.assertEqual(names["swarm_small"]["players_max"], 8)
        checked = run("lockwind", "scenes", "--check", "heap_64", "--json")
        self.assertEqual(checked.returncode, 0)
        self.assertEqual(json.loads(checked.stdout)["bodies"], 65)

    def test_scenes_are_text(self):
        scene = self.folder / "bytes"
        scene.write_bytes(b'name: "a\xff"\n')
        done = run("lockwind", "scenes", "--check", scene, "--json")
        self.assertEqual(done.returncode, 2)
        self.assertIn("not UTF-8", json.loads(done.stdout)["error"])

    def test_scenes_names_line_and_field_of_a_mistake(self):
        scene = self.file("bad.textproto", 'name: "bad"\nbody {\n  sphere { radius: -1 }\n}\n')
        done = run("lockwind", "scenes", "--check", scene)
        self.assertEqual(done.returncode, 2)
        self.assertIn(f"{scene}:3:12: body[0].sphere.radius is -1 m", done.stderr)


class Documents(unittest.TestCase):
    def commands(self):
        """(document, words) of each program call in a shell block of a document."""
        for document in sorted(ROOT.rglob("*.md")):
            if "build" in document.relative_to(ROOT).parts:
                continue
            text = document.read_text(encoding="utf-8")
            for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL):
                for line in block.replace("\\\n", " ").splitlines():
                    for call in re.split(r"&&|\|\||[|;]", line.split(" #")[0]):
                        words = shlex.split(call, comments=True)
                        if words:
                            yield document.relative_to(ROOT), words

    def test_scripts_and_programs_they_show_exist(self):
        count = 0
        for document, words in self.commands():
            name = words[0].removeprefix("./")
            if name.startswith("scripts/"):
                self.assertTrue((ROOT / name).is_file(), f"{document}: {name}")
                count += 1
            elif "lockwind" in pathlib.PurePath(name).name:
                program = pathlib.PurePath(name).name
                if program == "lockwind-bench":
                    continue
                self.assertTrue((OPTIONS.bin / program).is_file(), f"{document}: {name}")
                count += 1
        self.assertGreater(count, 5)

    def test_flags_they_show_are_known(self):
        for document, words in self.commands():
            program = pathlib.PurePath(words[0]).name
            if program not in ("lockwind", "lockwind-server"):
                continue
            command = [program] + (words[1:2] if program == "lockwind" else [])
            shown = run(*command, "--help").stdout
            for word in words[1:]:
                if word.startswith("--"):
                    flag = word.split("=")[0]
                    self.assertRegex(shown, rf"{flag}\b", f"{document}: {' '.join(words)}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    OPTIONS, rest = parser.parse_known_args()
    OPTIONS.bin = OPTIONS.bin.resolve()
    unittest.main(argv=[sys.argv[0], *rest])
