#!/usr/bin/env python3
"""Checks what a demo match printed and tells it to a person. Exits 1, saying why, where it does not hold."""
import argparse
import json
import pathlib
import subprocess
import sys

BOTS = (1, 2, 3, 4)
# An input delay of two ticks rides out this much; a machine that is late by more stalls any match.
STALL_US = 33_000


def load(path):
    try:
        return json.loads(pathlib.Path(path).read_text())
    except (OSError, ValueError) as error:
        sys.exit(f"demo: {path}: {error}")


def require(condition, message):
    if not condition:
        sys.exit(f"demo: {message}")


def bots_of(prefix):
    return [bot for n in BOTS for bot in load(f"{prefix}.bot-{n}.json")["bots"]]


def row(label, value):
    print(f"  {label:<22}{value}")


def match(options):
    server = load(f"{options.prefix}.server.json")
    timer = load(f"{options.prefix}.timer.json")
    late = server["tick_lateness_us"]
    row("ticks, players", f"{server['ticks']}, {server['players']}")
    row("state hash", f"{server['state_hash']} at tick {server['state_hash_tick']}")
    row("contacts a tick", f"{server['contacts']} (median)")
    row("bodies created, gone", f"{server['created']}, {server['destroyed']}")
    row("lateness p50/p99/max", f"{late['p50']}/{late['p99']}/{late['max']} us")
    row("bare timer, the same", f"{timer['p50']}/{timer['p99']}/{timer['max']} us")
    row("step p50/p99/max", "{p50}/{p99}/{max} us".format(**server["step_us"]))
    row("stalls, desyncs", f"{server['stalls']}, {server['desyncs']}")
    bots = bots_of(options.prefix)
    require(len(bots) == len(BOTS), "a bot is missing")
    for bot in sorted(bots, key=lambda one: one["slot"]):
        same = bot["state_hash"] == server["state_hash"]
        row(f"bot in slot {bot['slot']}", f"{bot['state_hash']} {'the same' if same else 'DIFFERS'}; "
            f"rtt p50 {bot['rtt_us']['p50']} us, stalls {bot['stalls']}")
        require(same and bot["state_hash_tick"] == server["state_hash_tick"], "a bot's hash differs")
    require(server["desyncs"] == 0, "a desync happened")
    require(server["created"] >= 100 and server["destroyed"] >= 100, "hardly anything was created")
    require(late["p99"] <= max(2000, 2 * timer["p99"]), "the match did not keep pace")
    if timer["max"] > STALL_US:
        print(f"  (this machine stood still for {timer['max'] / 1000:.0f} ms: a stall is its own)")
    else:
        require(server["stalls"] == 0, "the match stalled")


def replay(options):
    server = load(f"{options.prefix}.server.json")
    result = load(options.file)
    row("hashes checked", result["hashes_checked"])
    row("first bad tick", result["first_bad_tick"])
    row("state hash", result["state_hash"])
    row("speed", f"{result['realtime_factor']:.1f} x real time")
    require(result["first_bad_tick"] is None, "the log does not verify")
    require(result["hashes_checked"] >= server["ticks"], "not every tick's hash was checked")
    require(result["state_hash"] == server["state_hash"], "the replay ends in another state")


def desync(options):
    server = load(f"{options.prefix}.server.json")
    require(server["desyncs"] == 1, f"{server['desyncs']} desyncs, not 1")
    found = server["desync"][0]
    bundle = found["bundle"]
    row("detected", f"slot {found['slot']} at tick {found['tick']}, verdict {found['verdict']}")
    row("bundle", bundle)
    text = subprocess.run([options.diff, "diff", bundle], capture_output=True, text=True, check=False)
    print()
    print("\n".join("    " + line for line in text.stdout.splitlines()))
    run = subprocess.run([options.diff, "diff", bundle, "--json"], capture_output=True, text=True, check=False)
    require(run.returncode == 1, f"lockwind diff exits {run.returncode}, not 1: {run.stderr}")
    told = json.loads(run.stdout)
    for key in ("first_tick", "phase", "section", "entity", "field", "a", "b", "verdict"):
        require(told.get(key) is not None, f"the diff names no {key}")
    if options.tick is not None:
        require(found["tick"] == options.tick and told["first_tick"] == options.tick,
                f"corrupted at {options.tick}, detected at {found['tick']}, told as {told['first_tick']}")
    require(told["verdict"] == options.verdict, f"verdict {told['verdict']}, not {options.verdict}")
    require(told["phase"] == options.phase, f"phase {told['phase']}, not {options.phase}")
    pathlib.Path(f"{options.prefix}.diff.json").write_text(run.stdout)


def summary(options):
    folder = pathlib.Path(options.folder)
    server = load(folder / "match.server.json")
    result = load(folder / "replay.json")
    row("match", f"{server['ticks']} ticks, 5 processes, one hash {server['state_hash']}")
    row("replay", f"{result['hashes_checked']} hashes checked, all equal, "
        f"{result['realtime_factor']:.0f} x real time")
    for name in ("corrupted", "nondeterministic"):
        told = load(folder / f"{name}.diff.json")
        row(name, f"tick {told['first_tick']}, {told['phase']}, {told['section']} "
            f"{told['entity']}, {told['field']}: {told['verdict']}")
    print(f"\nFiles are in {folder}:")
    for path in sorted(folder.iterdir()):
        print(f"  {path.name:<36}{path.stat().st_size:>10} bytes")
    print("\nNext: build/release/bin/lockwind --help, build/release/bin/lockwind-server --help")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(required=True)
    one = commands.add_parser("match")
    one.add_argument("prefix")
    one.set_defaults(run=match)
    one = commands.add_parser("replay")
    one.add_argument("prefix")
    one.add_argument("file")
    one.set_defaults(run=replay)
    one = commands.add_parser("desync")
    one.add_argument("prefix")
    one.add_argument("--tick", type=int)
    one.add_argument("--verdict", required=True)
    one.add_argument("--phase", required=True)
    one.add_argument("--diff", required=True, help="the lockwind program")
    one.set_defaults(run=desync)
    one = commands.add_parser("summary")
    one.add_argument("folder")
    one.set_defaults(run=summary)
    options = parser.parse_args()
    options.run(options)


if __name__ == "__main__":
    main()
