"""The headline table, as README.md has it."""

ENGINES = ("lockwind", "lockwind_scalar", "lockwind_sse4", "lockwind_avx2", "lockwind_avx512", "lockwind_neon")


def present_engines(results):
    """Of Lockwind, those that this processor runs."""
    return [engine for engine in ENGINES
            if any(engine in scene["engines"] for scene in results["scenes"].values())]


def title(engine):
    return "best" if engine == "lockwind" else engine.removeprefix("lockwind_")


def milliseconds(us):
    return f"{us / 1000:.2f}"


def ratio(value):
    return "-" if value is None else f"{value:.2f}"


def headline(results):
    """Rows of strings, the first of them the head: a step's time over Bullet's."""
    engines = present_engines(results)
    rows = [["scene", *map(title, engines), "Bullet, ms", "Lockwind, ms", "p99 / median"]]
    for name, scene in results["scenes"].items():
        of = scene["engines"]
        bullet = milliseconds(of["bullet"]["mean_us"]) if "bullet" in of else "-"
        best = of["lockwind"]
        rows.append([name, *(ratio(of[engine]["to_bullet"] if engine in of else None) for engine in engines),
                     bullet, milliseconds(best["mean_us"]), ratio(best["p99_over_p50"])])
    return rows


def markdown(results):
    head, *rows = headline(results)
    lines = [head, ["---"] * len(head), *([f"`{row[0]}`", *row[1:]] for row in rows)]
    machine = results["machine"]
    caches = ", ".join(f"{name} {size}" for name, size in machine["caches"].items())
    foot = (f"{machine['cpu']} ({machine['architecture']}, {machine['cores']} cores; {caches}); "
            f"{machine['compiler']} {machine['flags']}; commit {machine['commit']}")
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n\n" + foot + "\n"
