"""The machine that figures belong to."""

import json
import os
import platform
import subprocess


def lscpu():
    """What lscpu says, by field; nothing where there is no lscpu."""
    try:
        text = subprocess.run(["lscpu", "--json"], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return {}
    fields = {}
    pending = list(json.loads(text)["lscpu"])
    while pending:
        entry = pending.pop()
        fields[entry["field"].rstrip(":")] = entry.get("data") or ""
        pending += entry.get("children", [])
    return fields


def build(info):
    """Of the program that was measured, whatever the sources are by now."""
    compiler, flags, _, _, commit = info.split("; ")
    return {"compiler": compiler, "flags": flags, "commit": commit.removeprefix("commit ")}


def describe(context):
    """`context` is that of lockwind-bench: sim_version, and build_info with compiler, flags and commit."""
    fields = lscpu()
    caches = {name.removesuffix(" cache"): size for name, size in sorted(fields.items())
              if name.endswith(" cache")}
    return {
        "cpu": fields.get("Model name") or platform.processor() or platform.machine(),
        "cpu_family_model": "/".join(fields.get(name, "?") for name in ("CPU family", "Model")),
        "architecture": platform.machine(),
        "cores": os.cpu_count(),
        "caches": caches,
        "kernel": platform.release(),
        "load_average": round(os.getloadavg()[0], 1),
        **build(context["build_info"]),
        "sim_version": context["sim_version"],
    }
