#!/usr/bin/env python3
"""Layers include only what stands to their left (ARCHITECTURE.md); some headers belong to one layer.

Usage: scripts/check_layers.py [--root DIR]
Prints file:line and what is wrong; exits 1 if anything is.
"""

import argparse
import pathlib
import re
import sys

# Layer: the layers directly to its left.
LEFT_OF = {
    "base": [],
    "math": ["base"],
    "geometry": ["math"],
    "dynamics": ["geometry"],
    "systems": ["dynamics"],
    "world": ["systems"],
    "simulation": ["base"],
    "session": ["simulation"],
    "session_world": ["session", "world"],
    "transport": ["base"],
    "transport_sim": ["transport"],
    "transport_dds": ["transport"],
    "codec": ["session"],
    "scene": ["world"],
    "log": ["codec"],
    "program": ["session"],
    "forensics": ["session_world", "scene", "log"],
    "match": ["forensics", "transport"],
    "bot": ["forensics", "transport"],
    "server": ["match", "program", "transport_dds"],
    "client": ["bot", "program", "transport_dds", "transport_sim"],
    "tests": ["server", "client", "match"],
}

# The longest folder that a file lies in decides its layer.
FOLDERS = {
    **{f"sim-core/src/{name}": name for name in
       ("base", "math", "geometry", "dynamics", "systems", "world", "simulation", "session",
        "session_world")},
    "proto/transport": "transport",
    "proto/transport/sim": "transport_sim",
    "proto/transport/dds": "transport_dds",
    "proto/codec": "codec",
    "proto/scene": "scene",
    "proto/log": "log",
    "server/program": "program",
    "server/match": "match",
    "server": "server",
    "client/forensics": "forensics",
    "client/bot": "bot",
    "client": "client",
    "tests": "tests",
}

# sim-core/include/lockwind is one folder for all layers of the core.
PUBLIC = {
    "base": "assert event hash_tree kept_state phase_observer result schema slot_input types",
    "math": "eigen fixed int128 integer overflow rng trig vector wide",
    "geometry": "shape",
    "dynamics": "level_of_detail simd world_definition",
    "systems": "player_input",
    "world": "ccd query world",
    "simulation": "simulation",
    "session": "session",
    "session_world": "world_simulation",
}
PUBLIC_LAYER = {f"{name}.h": layer for layer, names in PUBLIC.items() for name in names.split()}

# Headers that few layers may see, besides tests: pattern, layers, why.
RESERVED = [
    (r"scene\.pb\.h", {"scene"}, "scene text is read by scene alone"),
    (r"log\.pb\.h", {"log"}, "the log's records are read and written by log alone"),
    (r"forensics\.pb\.h", {"forensics"}, "traces and bundles are read and written by forensics alone"),
    (r".*\.pb\.h", {"codec"}, "messages become structs in codec"),
    (r"dds/.*|envelope\.h", {"transport_dds"}, "DDS is seen by its transport alone"),
    (r"CLI/.*", {"server", "client", "program"}, "command lines belong to the programs and what they share"),
    (r"Eigen/.*", {"math"}, "Eigen stays behind lockwind/eigen.h"),
    (r"google/protobuf/.*", {"codec", "scene", "log", "forensics"},
     "protobuf stays with those who own a format"),
]

INCLUDE_ROOTS = ["sim-core/include", "sim-core/src", "proto", "server", "client", ""]
SOURCES = ("sim-core", "proto", "server", "client", "tests")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def reach(layer, seen=None):
    """The layer and all that stands to its left."""
    seen = set() if seen is None else seen
    if layer not in seen:
        seen.add(layer)
        for left in LEFT_OF[layer]:
            reach(left, seen)
    return seen


REACH = {layer: reach(layer) for layer in LEFT_OF}


def layer_of(path):
    """Layer of a path relative to the root; None outside every layer."""
    if path.parent.as_posix() == "sim-core/include/lockwind":
        return PUBLIC_LAYER.get(path.name)
    for folder in path.parents:
        if folder.as_posix() in FOLDERS:
            return FOLDERS[folder.as_posix()]
    return None


def resolve(root, file, name):
    """The project's file that an include names, relative to the root; None for others'."""
    for base in [file.parent.as_posix(), *INCLUDE_ROOTS]:
        path = pathlib.PurePosixPath(base) / name
        if (root / path).is_file():
            return path
    return None


def check_include(root, file, layer, name):
    """What is wrong with one include, or None."""
    for pattern, layers, why in RESERVED:
        if re.fullmatch(pattern, name):
            allowed = layer in layers or layer == "tests"
            return None if allowed else f"{layer} includes {name}: {why}"
    target = resolve(root, file, name)
    if target is None:
        return None
    target_layer = layer_of(target)
    if target_layer is None or target_layer in REACH[layer]:
        return None
    return f"{layer} includes {name} of {target_layer}, which does not stand to its left"


def check_file(root, file):
    """All complaints about one file."""
    layer = layer_of(file)
    if layer is None:
        return [f"{file}:1: belongs to no layer: name its layer in scripts/check_layers.py"]
    complaints = []
    lines = (root / file).read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines, 1):
        match = INCLUDE.match(line)
        wrong = check_include(root, file, layer, match.group(2)) if match else None
        if wrong:
            complaints.append(f"{file}:{number}: {wrong}")
    return complaints


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--root", type=pathlib.Path, default=default)
    root = parser.parse_args().root.resolve()
    files = [pathlib.PurePosixPath(path.relative_to(root))
             for source in SOURCES for path in sorted((root / source).rglob("*"))
             if path.suffix in (".h", ".cpp")]
    if not files:
        sys.exit(f"check_layers: no sources under {root}")
    complaints = [complaint for file in files for complaint in check_file(root, file)]
    print(*complaints, sep="\n", end="\n" if complaints else "")
    print(f"check_layers: {len(files)} files, {len(complaints)} wrong")
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()
