"""The report as one page that needs nothing beside it."""

import html

from reporting import plots, table

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1c1c1c; max-width: 62rem; margin: 2rem auto; padding: 0 1rem }
h1, h2 { line-height: 1.2 } h2 { margin-top: 2.5rem }
svg { width: 100%; height: auto }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 1rem 0 }
td, th { padding: .2rem .8rem; border-bottom: 1px solid #ddd; text-align: right }
td:first-child, th:first-child { text-align: left }
p.note { color: #555 }
"""


def table_of(rows):
    head, *body = [[html.escape(str(cell)) for cell in row] for row in rows]
    lines = ["<tr>" + "".join(f"<th>{cell}</th>" for cell in head) + "</tr>"]
    lines += ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in body]
    return "<table>\n" + "\n".join(lines) + "\n</table>"


def section(title, note, *parts):
    return "\n".join([f"<h2>{html.escape(title)}</h2>", f'<p class="note">{html.escape(note)}</p>', *parts])


def machine(results):
    about = dict(results["machine"])
    caches = about.pop("caches")
    about["caches"] = ", ".join(f"{name} {size}" for name, size in caches.items())
    about["runs"] = f"{results['settings']['repetitions']}, {results['settings']['heavy_repetitions']} of heavy ones"
    return table_of([["", ""], *([name.replace("_", " "), value] for name, value in about.items())])


def steps(results):
    rows = [["scene", "engine", "to Bullet", "lowest", "highest", "mean, us", "p50, us", "p99, us", "p99 / p50",
             "contacts", "penetration, mm"]]
    for name, scene in results["scenes"].items():
        for engine, of in scene["engines"].items():
            rows.append([name, engine, table.ratio(of["to_bullet"]), table.ratio(of["to_bullet_low"]),
                         table.ratio(of["to_bullet_high"]), f"{of['mean_us']:.0f}", f"{of['p50_us']:.0f}",
                         f"{of['p99_us']:.0f}", f"{of['p99_over_p50']:.2f}", f"{of['contacts']:.0f}",
                         f"{of['penetration_mm']:.2f}"])
    return table_of(rows)


def hashes(results):
    return table_of([["scene", "state hash of every engine and run"],
                     *([name, scene["state_hash"]] for name, scene in results["scenes"].items())])


def growth(results):
    of = results["growth"]
    rows = [["curve", "from, bodies", "to, bodies", "time a body, to / from"]]
    for curve in of["step_us"]:
        rows.append([curve, *of[f"{curve}_bodies"], table.ratio(of[f"{curve}_per_body"])])
    return table_of(rows) + f"<p>Asleep over awake: {of['asleep_over_awake']:.4f}</p>"


def phases(results):
    names = list(next(iter(results["phases"].values()))["shares"])
    rows = [["scene", *names]]
    for scene, of in results["phases"].items():
        rows.append([scene, *(f"{100 * of['shares'][name]:.1f} %" for name in names)])
    return table_of(rows)


def snapshots(results):
    rows = [["scene", "bytes", "a body", "kept bytes", "keep / memcpy", "restore / memcpy", "hash / XXH3",
             "keep, us", "restore, us", "hash, us", "save, us", "load, us"]]
    for scene, of in results["snapshots"].items():
        over = ("keep_over_memcpy", "restore_over_memcpy", "hash_over_xxh3")
        work = ("keep_us", "restore_us", "hash_us", "save_us", "load_us")
        rows.append([scene, f"{of['bytes']:.0f}", f"{of['bytes_per_body']:.0f}", f"{of['kept_bytes']:.0f}",
                     *(f"{of[name]:.2f}" for name in over), *(f"{of[name]:.1f}" for name in work)])
    return table_of(rows)


def rollback(results):
    rows = [["scene", "steps", "us", "contacts"]]
    for scene, of in results["rollback"].items():
        rows.append([scene, f"{of['steps']:.2f}", f"{of['us']:.0f}", f"{of['contacts']:.0f}"])
    return table_of(rows)


def replay(results):
    of = results["replay"]
    if of is None:
        return []
    return [section("Replay", f"{of['ticks']} ticks, {of['hashes_checked']} hashes checked: "
                              f"{of['realtime_factor']:.0f} times real time.")]


def render(results):
    body = [
        "<h1>Lockwind, measured</h1>", machine(results),
        section("Against Bullet", "A step's time over Bullet's on the same bodies; each ratio is the median over "
                "passes, in which the two ran one after the other.", plots.ratios(results), steps(results)),
        section("The same bits", "Checked before anything was written.", hashes(results)),
        section("Slow steps", "The median step and the one in a hundred.", plots.tails(results)),
        section("Growth", "1 is a time in proportion to the bodies.", plots.growth(results), growth(results)),
        section("Phases", "Where a step's time goes.", plots.phases(results), phases(results)),
        section("Snapshots", "After 120 ticks; memcpy of the kept bytes and one-shot XXH3-64 of the state's are the floor.",
                plots.snapshots(results), snapshots(results)),
        section("Rollback", "8 ticks back, then 9 times step, keep and hash, as multiples of one step.",
                plots.rollback(results), rollback(results)),
        *replay(results),
    ]
    return ("<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Lockwind, measured</title>"
            f"<style>{STYLE}</style>\n" + "\n".join(body) + "\n</html>\n")
