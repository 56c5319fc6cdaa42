"""From the passes of lockwind-bench to the figures of the report: medians, ratios, shares."""

import re
import statistics

from reporting.measure import BenchError

# These time themselves; for the others the processor's time counts.
SELF_TIMED = ("step/", "phases/", "rollback/")
MICROSECONDS = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}
SNAPSHOT_WORK = ("keep", "restore", "save", "load", "hash", "memcpy", "xxh3")


class Runs:
    """All passes; a benchmark need not be in each."""

    def __init__(self, passes):
        self.passes = passes
        self.names = list(dict.fromkeys(name for rows in passes for name in rows))

    def rows(self, name):
        return [rows[name] for rows in self.passes if name in rows]

    def times_us(self, name):
        clock = "real_time" if name.startswith(SELF_TIMED) else "cpu_time"
        return [row[clock] * MICROSECONDS[row["time_unit"]] for row in self.rows(name)]

    def median_us(self, name):
        return statistics.median(self.times_us(name))

    def median(self, name, counter):
        return statistics.median(row[counter] for row in self.rows(name))

    def ratios(self, name, to):
        """A pass's time over that of `to` in the same pass."""
        both = Runs([rows for rows in self.passes if name in rows and to in rows])
        return [a / b for a, b in zip(both.times_us(name), both.times_us(to))]

    def matching(self, pattern):
        """Names and what the pattern's groups are in them."""
        found = ((name, re.fullmatch(pattern, name)) for name in self.names)
        return [(name, *match.groups()) for name, match in found if match]


def state_hash(runs, scene, engines):
    """The one state hash in which every run of the scene ends."""
    seen = {}
    for engine in engines:
        for row in runs.rows(f"step/{scene}/{engine}"):
            match = re.fullmatch(r"state_hash=([0-9a-f]{16})", row.get("label", ""))
            if not match:
                raise BenchError(f"step/{scene}/{engine} tells no state hash")
            seen.setdefault(match[1], set()).add(engine)
    if len(seen) != 1:
        told = "; ".join(f"{value} by {', '.join(sorted(by))}" for value, by in sorted(seen.items()))
        raise BenchError(f"{scene} does not end in one state: {told}")
    return next(iter(seen))


def engine_figures(runs, scene, engine):
    name = f"step/{scene}/{engine}"
    figures = {"mean_us": runs.median_us(name)}
    for counter in ("p50_us", "p99_us", "awake", "contacts", "penetration_mm"):
        figures[counter] = runs.median(name, counter)
    figures["p99_over_p50"] = statistics.median(row["p99_us"] / row["p50_us"] for row in runs.rows(name))
    ratios = runs.ratios(name, f"step/{scene}/bullet")
    figures["runs"] = len(runs.rows(name))
    figures["to_bullet"] = statistics.median(ratios) if ratios else None
    figures["to_bullet_low"] = min(ratios, default=None)
    figures["to_bullet_high"] = max(ratios, default=None)
    return figures


def scenes(runs):
    engines = {}
    for _, scene, engine in runs.matching(r"step/(\w+)/(\w+)"):
        engines.setdefault(scene, []).append(engine)
    return {scene: {
        "state_hash": state_hash(runs, scene, [engine for engine in of_scene if engine != "bullet"]),
        "engines": {engine: engine_figures(runs, scene, engine) for engine in of_scene},
    } for scene, of_scene in engines.items()}


def phases(runs):
    result = {}
    for name, scene in runs.matching(r"phases/(\w+)"):
        counters = [key for key in runs.rows(name)[0] if key.endswith("_us")]
        times = {key.removesuffix("_us"): runs.median(name, key) for key in counters}
        times = dict(sorted(times.items(), key=lambda phase: -phase[1]))
        total = sum(times.values())
        result[scene] = {"step_us": total, "shares": {phase: us / total for phase, us in times.items()}}
    return result


def snapshots(runs):
    result = {}
    for name, scene in runs.matching(r"save/(\w+)"):
        figures = {"bodies": runs.median(name, "bodies"), "bytes": runs.median(name, "snapshot_bytes"),
                   "kept_bytes": runs.median(f"keep/{scene}", "snapshot_bytes")}
        figures["bytes_per_body"] = figures["bytes"] / figures["bodies"]
        for work in SNAPSHOT_WORK:
            figures[f"{work}_us"] = runs.median_us(f"{work}/{scene}")
        for work, floor in (("keep", "memcpy"), ("restore", "memcpy"), ("hash", "xxh3")):
            ratios = runs.ratios(f"{work}/{scene}", f"{floor}/{scene}")
            figures[f"{work}_over_{floor}"] = statistics.median(ratios)
        result[scene] = figures
    return result


def rollback(runs):
    return {scene: {"us": runs.median_us(name), "steps": runs.median(name, "steps"),
                    "contacts": runs.median(name, "contacts")}
            for name, scene in runs.matching(r"rollback/(\w+)")}


def growth(runs):
    curves = {"separate": {}, "resting_awake": {}, "resting_asleep": {}, "heap": {}}
    for name, curve, count in runs.matching(r"growth/(\w+?)_(\d+)"):
        curves[curve][count] = runs.median_us(name)
    for name, count in runs.matching(r"step/heap_(\d+)/lockwind"):
        curves["heap"][count] = runs.median_us(name)
    result = {"step_us": curves}
    for curve, times in curves.items():
        # 1 where a step's time is in proportion to the bodies.
        first, last = min(times, key=int), max(times, key=int)
        per_body = [times[count] / int(count) for count in (first, last)]
        result[f"{curve}_bodies"] = [int(first), int(last)]
        result[f"{curve}_per_body"] = per_body[1] / per_body[0] if first != last else None
    most = max(curves["resting_awake"], key=int)
    result["asleep_over_awake"] = statistics.median(
        runs.ratios(f"growth/resting_asleep_{most}", f"growth/resting_awake_{most}"))
    return result


def summarize(passes):
    runs = Runs(passes)
    return {
        "scenes": scenes(runs),
        "phases": phases(runs),
        "snapshots": snapshots(runs),
        "rollback": rollback(runs),
        "growth": growth(runs),
        "runs_us": {name: runs.times_us(name) for name in runs.names},
    }
