#!/usr/bin/env python3
"""Every feature of tests/features.toml has a test that fails when the feature is switched off.

Usage: scripts/check_features.py [--names] [--build DIR] [FEATURE ...]
  --names        looks only whether changes and tests are there, by the programs of --build: seconds
  --build DIR    a build of the tree; default build/release
  FEATURE        only these; default all

Makes each change in a copy of the sources, builds the test's program there, and runs the test: with all
changes undone it must pass, with its own it must fail. Prints a table; an hour for all of them. Exit code 1
where a test passed without its feature, a change does not build, or a name leads nowhere.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[1]
FOLDERS = ["sim-core", "proto", "server", "client", "tests", "scripts"]
FILES = ["CMakeLists.txt", "CMakePresets.json"]


def read_features(names):
    features = tomllib.loads((ROOT / "tests/features.toml").read_text(encoding="utf-8"))["feature"]
    unknown = set(names) - {feature["name"] for feature in features}
    if unknown:
        sys.exit(f"check_features: no feature {', '.join(sorted(unknown))}")
    return [feature for feature in features if not names or feature["name"] in names]


def run(*command, **options):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, **options)


def program_of(feature):
    return feature["test"].split(" ", 1)[0]


def test_command(build, feature):
    _, *tests = feature["test"].split(" ", 1)
    return [build / "bin" / program_of(feature), *(f"--gtest_filter={names}" for names in tests)]


def missing(feature, build):
    """What is wrong with an entry, or ""."""
    path = ROOT / feature["file"]
    if not path.exists():
        return f"no file {feature['file']}"
    places = path.read_text(encoding="utf-8").count(feature["from"])
    if places != 1:
        return f"{places} places in {feature['file']} read as `from`"
    command = test_command(build, feature)
    if not command[0].exists():
        return f"no program {command[0]}"
    if len(command) == 1:
        return ""  # an example, which is a test as a whole
    listed = run(*command, "--gtest_list_tests").stdout
    return "" if any(line.startswith("  ") for line in listed.splitlines()) else f"no test {feature['test']}"


def check_names(features, build):
    wrong = 0
    for feature in features:
        if why := missing(feature, build):
            print(f"tests/features.toml: {feature['name']}: {why}")
            wrong += 1
    print(f"check_features: {len(features)} features, {wrong} wrong")
    return wrong


def copy_tree(target):
    for folder in FOLDERS:
        shutil.copytree(ROOT / folder, target / folder, ignore=shutil.ignore_patterns("__pycache__"))
    for file in FILES:
        shutil.copy(ROOT / file, target)


def build_program(tree, program):
    return run("cmake", "--build", tree / "build/release", "--target", program, "-j", os.cpu_count())


def switch_off(tree, feature):
    """(how the test was seen to fail, or None; what happened)"""
    path = tree / feature["file"]
    text = path.read_text(encoding="utf-8")
    program = program_of(feature)
    try:
        path.write_text(text.replace(feature["from"], feature["to"]), encoding="utf-8")
        built = build_program(tree, program)
        if built.returncode != 0:
            lines = [line for line in built.stdout.splitlines() if "error" in line]
            return None, "the change does not build: " + (lines or ["?"])[0]
        try:
            tested = run(*test_command(tree / "build/release", feature), timeout=600)
        except subprocess.TimeoutExpired:
            return "no end within ten minutes", ""
        failed = sorted({line.split()[3].rstrip(",") for line in tested.stdout.splitlines()
                         if line.startswith("[  FAILED  ]") and "listed below" not in line})
        if failed:
            return ", ".join(failed), ""
        if tested.returncode != 0:
            return f"ended with {tested.returncode}", ""
        return None, "passes without the feature"
    finally:
        path.write_text(text, encoding="utf-8")


def check_changes(features, tree):
    copy_tree(tree)
    configured = run("cmake", "--preset", "release", cwd=tree)
    if configured.returncode != 0:
        sys.exit("check_features: cannot configure the copy\n" + configured.stderr)
    for program in sorted({program_of(feature) for feature in features}):
        print(f"builds {program}", flush=True)
        if build_program(tree, program).returncode != 0:
            sys.exit(f"check_features: {program} does not build unchanged")
    wrong = 0
    print("| feature | test | switched off, what fails |\n|---|---|---|", flush=True)
    for feature in features:
        if run(*test_command(tree / "build/release", feature)).returncode != 0:
            seen, why = None, "fails unchanged"
        else:
            seen, why = switch_off(tree, feature)
            build_program(tree, program_of(feature))
        wrong += 0 if seen else 1
        print(f"| {feature['name']} | {feature['test']} | {seen or 'WRONG: ' + why} |", flush=True)
    print(f"check_features: {len(features)} features, {wrong} wrong")
    return wrong


def main():
    parser = argparse.ArgumentParser(usage=__doc__, add_help=True)
    parser.add_argument("--names", action="store_true")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("features", nargs="*")
    options = parser.parse_args()
    features = read_features(options.features)
    wrong = check_names(features, options.build)
    if not wrong and not options.names:
        with tempfile.TemporaryDirectory(prefix="lockwind-features-") as folder:
            wrong = check_changes(features, pathlib.Path(folder))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
