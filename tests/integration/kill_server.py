#!/usr/bin/env python3
"""Kills the server of live matches at random moments and checks what their logs hold.

Each log must open, be told as interrupted, verify to its last confirmed tick, and hold every tick that
any bot had seen confirmed. Exits 1 at the first that does not.
"""
import argparse
import json
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

BOT_PROCESSES = 2
BOTS_A_PROCESS = 2


def run_json(command):
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} exits {done.returncode}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def ticks_in(lockwind, log):
    """Ticks that the log holds so far; 0 while it has none."""
    done = subprocess.run([lockwind, "info", log, "--json"], capture_output=True, text=True,
                          timeout=60, check=False)
    return json.loads(done.stdout)["ticks"] if done.returncode == 0 else 0


def one_run(number, options, draw, folder):
    lockwind = str(options.bin / "lockwind")
    log = str(folder / f"kill-{number}.log")
    name = f"kill-{number}"
    common = ["--domain", str(options.domain), "--match", name]
    server = subprocess.Popen(
        [str(options.bin / "lockwind-server"), "--scene", options.scene, "--players",
         str(BOT_PROCESSES * BOTS_A_PROCESS), "--ticks", "100000", "--log", log, *common],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    bots = [
        subprocess.Popen(
            [lockwind, "bots", "--count", str(BOTS_A_PROCESS), "--seed", str(100 * number + process),
             "--json", *common],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        for process in range(BOT_PROCESSES)
    ]
    started = time.monotonic()
    while ticks_in(lockwind, log) == 0:
        if time.monotonic() - started > 30:
            sys.exit(f"run {number}: the match does not start")
        time.sleep(0.05)
    time.sleep(draw.uniform(0.0, 2.0))
    server.send_signal(signal.SIGKILL)
    server.wait()
    time.sleep(0.2)  # what is on its way to the bots arrives
    for process in bots:
        process.send_signal(signal.SIGTERM)
    seen = 0
    for process in bots:
        report = json.loads(process.communicate(timeout=60)[0])
        seen = max([seen] + [bot["confirmed_tick"] for bot in report["bots"]])

    info = run_json([lockwind, "info", log, "--json"])
    replay = run_json([lockwind, "replay", log, "--verify", "--json"])
    told = (f"run {number}: {info['ended']}, {info['ticks']} ticks, bots saw {seen}, "
            f"verified to {replay['verified_to_tick']} with {replay['hashes_checked']} hashes")
    holds = (info["ended"] == "interrupted" and info["ticks"] >= seen > 0 and
             replay["first_bad_tick"] is None and replay["verified_to_tick"] == info["ticks"])
    print(told, flush=True)
    if not holds:
        sys.exit(f"run {number} does not hold")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of the programs")
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scene", default="arena")
    parser.add_argument("--domain", type=int, default=91)
    options = parser.parse_args()
    draw = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="lockwind-") as folder:
        for number in range(1, options.runs + 1):
            one_run(number, options, draw, pathlib.Path(folder))
    print(f"{options.runs} kills: every log holds what the bots had seen confirmed")


if __name__ == "__main__":
    main()
