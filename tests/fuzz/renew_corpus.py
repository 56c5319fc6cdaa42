#!/usr/bin/env python3
"""Writes the seeds of the fuzz targets anew: after a change of the state, the messages or a file's format
those of before are refused at once, and nothing behind that is fuzzed.

Plays two small matches over DDS on loopback, one of them with a corruption. What fuzzing added to the corpus
stays as it is.
"""
import argparse
import pathlib
import shutil
import subprocess
import tempfile

CORPUS = pathlib.Path(__file__).resolve().parent / "corpus"


def play(programs, folder, name, ticks, domain, corrupt=()):
    """The log of a match of two bots."""
    log = folder / f"{name}.log"
    common = ["--domain", str(domain), "--match", name]
    server = subprocess.Popen([programs / "lockwind-server", "--scene", "swarm_small", "--players", "2",
                               "--ticks", str(ticks), "--log", log, *common], stdout=subprocess.DEVNULL)
    bots = subprocess.Popen([programs / "lockwind", "bots", "--count", "2", "--seed", "1", *common, *corrupt],
                            stdout=subprocess.DEVNULL, cwd=folder)
    for process in (bots, server):
        process.wait(timeout=60)
    return log


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of the programs")
    parser.add_argument("--domain", type=int, default=93)
    options = parser.parse_args()
    programs = options.bin.resolve()

    def replay(log, *arguments):
        subprocess.run([programs / "lockwind", "replay", log, *arguments], check=True, timeout=60,
                       stdout=subprocess.DEVNULL)

    subprocess.run([programs / "write_fuzz_seeds", CORPUS], check=True, timeout=60)
    with tempfile.TemporaryDirectory(prefix="lockwind-seeds-") as name:
        folder = pathlib.Path(name)
        complete = play(programs, folder, "complete", 60, options.domain)
        shutil.copy(complete, CORPUS / "log/complete")
        replay(complete, "--from", "55", "--trace", folder / "hashes")
        shutil.copy(folder / "hashes", CORPUS / "trace/hashes")
        desync = play(programs, folder, "desync", 60, options.domain, ["--corrupt", "slot=1,tick=40"])
        shutil.copy(desync, CORPUS / "log/desync")
        bundle, = folder.glob("*.bundle")
        shutil.copy(bundle, CORPUS / "bundle/corrupted")
        replay(desync, "--to", "40", "--from", "39", "--trace", folder / "states", "--trace-states")
        shutil.copy(folder / "states", CORPUS / "trace/states")
        replay(desync, "--to", "40", "--snapshot", folder / "tick-40")
        shutil.copy(folder / "tick-40", CORPUS / "snapshot/tick-40")


if __name__ == "__main__":
    main()
