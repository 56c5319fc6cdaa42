#!/usr/bin/env python3
"""Lints every source with clang-tidy 14 as .clang-tidy says; warnings are errors.

Usage: scripts/check_tidy.py [--build DIR] [--jobs N] [--tests] [--fresh] [FILE ...]
       (default: build/release, all sources but tests; --fresh forgets what was found clean before)
The path-sensitive clang-analyzer runs on sim-core alone: elsewhere it costs most of the time. A file that
was clean is linted again only when it, one of its headers, its command or .clang-tidy has changed.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
TIDY = "clang-tidy-14"


def entries_of(build, wanted, with_tests):
    """Compile commands of the project's own sources: those wanted, or all."""
    entries = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        file = (pathlib.Path(entry["directory"]) / entry["file"]).resolve()
        if file.is_relative_to(ROOT) and not file.is_relative_to(build.resolve()):
            name = file.relative_to(ROOT).as_posix()
            folder = name.split("/")[0]
            chosen = name in wanted if wanted else with_tests or folder != "tests"
            if chosen and folder != "build" and file.suffix == ".cpp":
                entries[name] = entry
    return entries


def dependencies(build):
    """Object file: its headers, as ninja recorded them."""
    output = subprocess.run(["ninja", "-C", build, "-t", "deps"], check=True, capture_output=True,
                            text=True).stdout
    result = {}
    target = None
    for line in output.splitlines():
        if line.startswith("    "):
            result[target].append(line.strip())
        elif ": #deps" in line:
            target = line.split(": #deps")[0]
            result[target] = []
    return result


def digest(entry, headers, cache):
    """Hash of all that the verdict on one file depends on."""
    total = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    total.update(pathlib.Path(__file__).read_bytes())
    total.update(entry["command"].encode())
    for path in headers:
        if path.startswith("/usr/"):
            continue
        if path not in cache:
            file = pathlib.Path(entry["directory"]) / path
            cache[path] = hashlib.sha256(file.read_bytes()).digest() if file.is_file() else b""
        total.update(path.encode() + cache[path])
    return total.hexdigest()


def lint(build, name):
    """(output, ok, seconds) for one file."""
    checks = [] if name.startswith("sim-core/") else ["--checks=-clang-analyzer-*"]
    begin = time.monotonic()
    run = subprocess.run([TIDY, "--quiet", "-p", build, *checks, ROOT / name],
                         capture_output=True, text=True, check=False)
    noise = re.compile(r"^\d+ warnings? (?:generated|treated as errors?).*$\n?", re.MULTILINE)
    output = run.stdout + (noise.sub("", run.stderr) if run.returncode else "")
    return output, run.returncode == 0, time.monotonic() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--tests", action="store_true")
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("files", nargs="*")
    options = parser.parse_args()
    build = options.build.resolve()
    if not (build / "compile_commands.json").is_file():
        sys.exit(f"check_tidy: {build} is not configured: cmake --preset release")

    stamps = build / "tidy"
    stamps.mkdir(exist_ok=True)
    headers_of = dependencies(build)
    cache = {}
    todo = []
    entries = entries_of(build, set(options.files), options.tests)
    for name, entry in sorted(entries.items()):
        output = re.search(r" -o (\S+)", entry["command"]).group(1)
        headers = headers_of.get(output, [])
        stamp = stamps / digest(entry, headers, cache)
        if options.fresh or not headers or not stamp.exists():
            todo.append((name, stamp if headers else None))

    wrong = 0
    slowest = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = {pool.submit(lint, build, name): (name, stamp) for name, stamp in todo}
        for run in concurrent.futures.as_completed(runs):
            name, stamp = runs[run]
            output, clean, seconds = run.result()
            slowest.append((seconds, name))
            if clean and stamp:
                stamp.touch()
            if not clean:
                wrong += 1
                print(output, end="", flush=True)
    for seconds, name in sorted(slowest, reverse=True)[:3]:
        print(f"check_tidy: {seconds:5.1f} s {name}")
    print(f"check_tidy: {len(entries)} files, {len(todo)} linted, {wrong} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
