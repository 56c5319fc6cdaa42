#!/usr/bin/env python3
"""Gives the programs bad files, folders and domains, and checks that each is refused in words.

Records a match and a desync, then truncates, flips and swaps their files. Every refusal must be the
documented exit code with a message, never a crash or a hang, and must leave nothing half written. Exits 1
at the first that is not. Usage: bad_input.py --bin DIR [--all]
"""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import random
import resource
import signal
import subprocess
import sys
import tempfile

OPTIONS = None
TAIL_BYTES = 4096
FLIPS = 1000


def run(*command, expect, words="", **settings):
    """The finished process; exits unless its code is one of `expect` and it says `words`."""
    program, *arguments = map(str, command)
    shown = f"{program} {' '.join(arguments)}"
    try:
        done = subprocess.run([OPTIONS.bin / program, *arguments], capture_output=True, timeout=60,
                              check=False, **settings)
    except subprocess.TimeoutExpired:
        sys.exit(f"{shown}: hangs")
    said = done.stderr.decode(errors="replace").strip()
    if done.returncode not in expect:
        sys.exit(f"{shown}: exits {done.returncode}, not one of {sorted(expect)}: {said}")
    if done.returncode != 0 and not said and not done.stdout:
        sys.exit(f"{shown}: exits {done.returncode} without a word")
    if words not in said:
        sys.exit(f"{shown}: does not say '{words}': {said}")
    return done


def record(folder, name, *bot_flags):
    """Plays 120 ticks of swarm_small with two bots; the path of the log."""
    log = folder / f"{name}.log"
    common = ["--domain", str(OPTIONS.domain), "--match", name]
    server = subprocess.Popen(
        [OPTIONS.bin / "lockwind-server", "--scene", "swarm_small", "--players", "2", "--ticks", "120",
         "--log", log, *common], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    subprocess.run([OPTIONS.bin / "lockwind", "bots", "--count", "2", "--seed", "1", *common, *bot_flags],
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60, check=False)
    server.wait(timeout=60)
    return log


def commands_for(kind, file, sound):
    """What is run on a damaged file of a kind: words of a command."""
    if kind == "scene":
        return [["scenes", "--check", file]]
    commands = [["info", file]]
    if kind == "log":
        commands.append(["replay", "--verify", file])
    elif kind == "bundle":
        commands.append(["diff", file])
    else:
        commands.append(["diff", file, sound])
    return commands


def check_damaged(kind, file, bytes_, sound, at_boundary):
    """Runs all commands on a damaged file; the exit codes."""
    file.write_bytes(bytes_)
    # A log may end at any record: it is then told as interrupted. Scenes are text: other text may do.
    expect = {0, 3} if at_boundary else {3}
    if kind == "scene":
        expect = {0, 2, 3}
    codes = [run("lockwind", *command, expect=expect).returncode
             for command in commands_for(kind, file, sound)]
    file.unlink()
    return codes


def boundaries(content):
    """Sizes at which a file of records may end."""
    ends = {8}
    at = 8
    while at + 12 <= len(content):
        at += 12 + int.from_bytes(content[at:at + 4], "little")
        ends.add(at)
    return ends


def damage(kind, sound, folder, draw):
    """Truncates and flips one file in all wanted places."""
    content = sound.read_bytes()
    ends = boundaries(content) if kind == "log" else set()
    cuts = list(range(max(0, len(content) - TAIL_BYTES), len(content)))
    flips = [draw.randrange(8 * len(content)) for _ in range(FLIPS)]
    if not OPTIONS.all:
        cuts = draw.sample(cuts, min(len(cuts), 24))
        flips = flips[:24]
    cases = [(f"cut-{size}", content[:size], size in ends) for size in cuts]
    for number, bit in enumerate(flips):
        changed = bytearray(content)
        changed[bit // 8] ^= 1 << (bit % 8)
        cases.append((f"flip-{number}", bytes(changed), False))
    counts = collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(OPTIONS.jobs) as pool:
        tasks = [pool.submit(check_damaged, kind, folder / f"{kind}-{name}", bytes_, sound, boundary)
                 for name, bytes_, boundary in cases]
        for task in concurrent.futures.as_completed(tasks):
            counts.update(task.result())
    codes = ", ".join(f"exit {code}: {count}" for code, count in sorted(counts.items()))
    print(f"{kind}: {len(cuts)} cuts and {len(flips)} flipped bits of {len(content)} bytes: {codes}",
          flush=True)


def check_foreign_files(files, folder):
    empty = folder / "empty"
    empty.write_bytes(b"")
    foreign = folder / "foreign"
    foreign.write_bytes(b"\x7fELF" + bytes(range(256)) * 20)
    missing = folder / "missing"
    for kind, sound in files.items():
        others = [file for other, file in files.items() if other not in (kind, "scene")]
        for file in (missing, empty, foreign, folder):
            for command in commands_for(kind, file, sound):
                run("lockwind", *command, expect={2, 3})
        for other in others:
            if kind == "log":
                run("lockwind", "replay", other, expect={3}, words=str(other))
            elif kind in ("trace", "snapshot"):
                run("lockwind", "diff", sound, other, expect={2})
    empty.unlink()
    foreign.unlink()
    print("missing, empty, foreign files and folders are refused")


def check_scenes(folder):
    floor = "body { mode: fixed plane {} }\n"
    cases = {
        "unknown field": (f'name: "x"\n{floor}body {{ weight: 3 }}', "no field"),
        "zero density": (f'name: "x"\n{floor}body {{ sphere {{ radius: 1 }} density: 0 }}', "density"),
        "absurd density": (f'name: "x"\n{floor}body {{ sphere {{ radius: 1 }} density: 1e30 }}', "density"),
        "no size": (f'name: "x"\n{floor}body {{ box {{ half_extents {{ x: 0 y: 1 z: 1 }} }} }}',
                    "half_extents"),
        "a billion bodies": (f'name: "x"\n{floor}body {{ sphere {{ radius: 1 }} grid {{ count '
                             "{ x: 1000 y: 1000 z: 1000 } pitch { x: 3 y: 3 z: 3 } } }", "bodies"),
    }
    scene = folder / "scene.textproto"
    for name, (text, words) in cases.items():
        scene.write_text(text, encoding="utf-8")
        run("lockwind", "scenes", "--check", scene, expect={2}, words=words)
        run("lockwind-server", "--scene", scene, "--log", folder / "x.log", expect={2}, words=words)
    scene.unlink()
    print(f"scenes are refused: {', '.join(cases)}")


def check_places(files, folder):
    """Busy domains, full disks, folders that take no file."""
    server = [OPTIONS.bin / "lockwind-server", "--scene", "swarm_small", "--domain",
              str(OPTIONS.domain), "--join-timeout", "60"]
    first = subprocess.Popen([*server, "--log", folder / "busy.log"], stdout=subprocess.DEVNULL,
                             stderr=subprocess.PIPE, text=True)
    try:
        first.stderr.readline()  # it waits for players
        run("lockwind-server", "--scene", "empty", "--domain", OPTIONS.domain, "--log",
            folder / "second.log", expect={4}, words="domain")
    finally:
        first.send_signal(signal.SIGTERM)
        first.wait(timeout=60)
    (folder / "busy.log").unlink()
    nowhere = "/proc" if os.geteuid() == 0 else "/"
    run("lockwind-server", "--scene", "empty", "--log", f"{nowhere}/x.log", expect={3}, words="x.log")
    for name, flag in (("replay", "--trace"), ("replay", "--snapshot"), ("info", "--export")):
        run("lockwind", name, files["log"], flag, f"{nowhere}/x", expect={3}, words=f"{nowhere}/x")

    def full_disk():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

    for name, flag in (("replay", "--trace"), ("replay", "--snapshot"), ("info", "--export")):
        run("lockwind", name, files["log"], flag, folder / "half", expect={3}, words="half",
            preexec_fn=full_disk, restore_signals=False)
    print("a busy domain, folders that take no file and full disks are told")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of the programs")
    parser.add_argument("--all", action="store_true",
                        help="every cut of the last 4 KiB and 1,000 flips of each file, not a few")
    parser.add_argument("--domain", type=int, default=96)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    global OPTIONS
    OPTIONS = parser.parse_args()
    OPTIONS.bin = OPTIONS.bin.resolve()
    draw = random.Random(7)
    with tempfile.TemporaryDirectory(prefix="lockwind-bad-") as name:
        folder = pathlib.Path(name)
        log = record(folder, "sound")
        record(folder, "desync", "--corrupt", "slot=1,tick=60")
        bundles = list(folder.glob("*.bundle"))
        if len(bundles) != 1:
            sys.exit(f"the desync left {len(bundles)} bundles")
        run("lockwind", "replay", log, "--verify", "--from", 118, "--trace", folder / "sound.trace",
            "--trace-states", "--snapshot", folder / "sound.snapshot", expect={0})
        scene = folder / "sound.textproto"
        scene.write_text((pathlib.Path(__file__).resolve().parents[2] /
                          "sim-core/scenes/swarm_small.textproto").read_text(encoding="utf-8"))
        files = {"log": log, "trace": folder / "sound.trace", "bundle": bundles[0],
                 "snapshot": folder / "sound.snapshot", "scene": scene}
        before = sorted(folder.iterdir())
        check_foreign_files(files, folder)
        check_scenes(folder)
        check_places(files, folder)
        for kind, file in files.items():
            damage(kind, file, folder, draw)
        left = sorted(set(folder.iterdir()) - set(before))
        if left:
            sys.exit(f"left behind: {', '.join(map(str, left))}")
    print("nothing half written is left")


if __name__ == "__main__":
    main()
