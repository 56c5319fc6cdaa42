#!/usr/bin/env python3
"""Plays one live match with many bots in several processes, each bot with its own world.

Exits 1 unless the match is complete, without a desync, and all worlds end in the same state. Prints what
tells whether they kept pace.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of the programs")
    parser.add_argument("--bots", type=int, default=16)
    parser.add_argument("--processes", type=int, default=4, help="that the bots are spread over")
    parser.add_argument("--bots-bin", type=pathlib.Path, action="append", metavar="DIR",
                        help="folder of a bots' process, once for each: other builds than the server's")
    parser.add_argument("--log", type=pathlib.Path, help="keeps the match's log there")
    parser.add_argument("--scene", default="arena")
    parser.add_argument("--ticks", type=int, default=300)
    parser.add_argument("--tick-rate", type=int, default=10)
    parser.add_argument("--domain", type=int, default=95)
    options = parser.parse_args()
    folders = options.bots_bin or [options.bin] * options.processes
    if options.bots % len(folders) != 0:
        parser.error("--bots is no multiple of the processes")

    common = ["--domain", str(options.domain), "--match", "many", "--json"]
    with tempfile.TemporaryDirectory(prefix="lockwind-many-") as folder:
        commands = [[options.bin / "lockwind-server", "--scene", options.scene, "--players",
                     str(options.bots), "--ticks", str(options.ticks), "--tick-rate",
                     str(options.tick_rate), "--log", options.log or f"{folder}/many.log", *common]]
        commands += [[bin_folder / "lockwind", "bots", "--seed", str(process), "--count",
                      str(options.bots // len(folders)), *common]
                     for process, bin_folder in enumerate(folders)]
        processes = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
                     for command in commands]
        limit = 60 + 3 * options.ticks / options.tick_rate
        outputs = [process.communicate(timeout=limit)[0] for process in processes]
    for command, process in zip(commands, processes):
        if process.returncode != 0:
            sys.exit(f"{command[0]} exits {process.returncode}")
    report = json.loads(outputs[0])
    bots = [bot for output in outputs[1:] for bot in json.loads(output)["bots"]]
    states = {(bot["state_hash_tick"], bot["state_hash"]) for bot in bots}
    lateness = report["tick_lateness_us"]
    print(f"{len(bots)} bots in {len(folders)} processes, {report['ticks']} ticks at "
          f"{options.tick_rate} Hz: {report['desyncs']} desyncs, {report['stalls']} stalls, lateness "
          f"{lateness['p50']}/{lateness['p99']}/{lateness['max']} us p50/p99/max, "
          f"{report['contacts']} contacts, state {report['state_hash']}")
    same = states == {(report["state_hash_tick"], report["state_hash"])}
    if not same or report["desyncs"] != 0 or report["ticks"] != options.ticks:
        sys.exit(f"not one state at the end: {sorted(states)}")


if __name__ == "__main__":
    main()
