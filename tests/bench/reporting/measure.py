"""Runs lockwind-bench again and again, so that what is compared stands side by side in time."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

# What takes half a minute a pass.
HEAVY = re.compile(r"/heap_8000\b|_50000$")
# Enough for a page with a figure everywhere.
QUICK = re.compile(r"^(step|phases|save|load|keep|restore|hash|memcpy|xxh3|rollback)/pyramid_210\b"
                   r"|^step/heap_1000/(lockwind|bullet)$|^rollback/boxes_200|^growth/.*_1(000|0000)$")


class BenchError(Exception):
    """A measurement that is no measurement; the text is for a person."""


def run(program, *flags):
    done = subprocess.run([program, *flags], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BenchError(f"{program} exits {done.returncode}: {done.stderr.strip()[-500:]}")
    return done.stdout


def bare(name):
    """Without what the library appends: "/iterations:1/manual_time"."""
    return re.sub(r"(/iterations:\d+)?(/manual_time)?$", "", name)


def names(program):
    """Of all benchmarks, in the order in which a pass runs them."""
    return [bare(line) for line in run(program, "--benchmark_list_tests=true").split()]


def one_pass(program, wanted, min_seconds):
    """Each of `wanted` once: context, and rows by name."""
    pattern = f"^({'|'.join(map(re.escape, wanted))})(/iterations:1)?(/manual_time)?$"
    with tempfile.TemporaryDirectory(prefix="lockwind-bench-") as folder:
        out = pathlib.Path(folder) / "pass.json"
        run(program, f"--benchmark_filter={pattern}", f"--benchmark_min_time={min_seconds}",
            f"--benchmark_out={out}")
        told = json.loads(out.read_text())
    rows = {row["name"]: row for row in told["benchmarks"]}
    for name, row in rows.items():
        if row.get("error_occurred"):
            raise BenchError(f"{name}: {row.get('error_message')}")
    missing = [name for name in wanted if name not in rows]
    if missing:
        raise BenchError(f"lockwind-bench did not run {', '.join(missing)}")
    return told["context"], rows


def passes(program, options):
    """All passes: the program's context, and a list of rows by name for each pass.

    Each pass is a process of its own and runs a scene's engines one after the other. The library's random
    interleaving shuffles all repetitions instead: what is compared may then stand minutes apart.
    """
    wanted = [name for name in names(program) if not options.quick or QUICK.search(name)]
    light = [name for name in wanted if not HEAVY.search(name)]
    context, done = {}, []
    for index in range(options.repetitions):
        chosen = wanted if index < options.heavy_repetitions else light
        print(f"report: pass {index + 1} of {options.repetitions}, {len(chosen)} benchmarks",
              file=sys.stderr, flush=True)
        context, rows = one_pass(program, chosen, 0.01 if options.quick else 0.1)
        done.append(rows)
    return context, done


def replay(program, log):
    """What `lockwind replay` makes of a log, every hash checked."""
    told = json.loads(run(program, "replay", log, "--verify", "--json"))
    return {name: told[name] for name in ("ticks", "hashes_checked", "realtime_factor")}
