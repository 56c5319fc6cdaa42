"""The report's plots: each a function from results to an SVG that stands in a page."""

import io
import re

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # after the choice of its backend

from reporting import table

matplotlib.rcParams.update({
    "axes.axisbelow": True, "axes.grid": True, "axes.spines.right": False, "axes.spines.top": False,
    "font.family": "sans-serif", "font.size": 10, "grid.color": "#e3e3e3", "legend.frameon": False,
    "svg.fonttype": "none", "svg.hashsalt": "lockwind",
})


def svg(figure):
    """Inline: no XML head, no fixed size."""
    text = io.StringIO()
    figure.savefig(text, format="svg", bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)
    inline = text.getvalue()
    inline = inline[inline.index("<svg"):]
    return re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", inline))


def grouped_bars(axes, groups, series):
    """`series`: label to one value a group, None for no bar; `groups` name them."""
    width = 0.8 / len(series)
    for index, (label, values) in enumerate(series.items()):
        places = [group + width * (index + 0.5) - 0.4 for group in range(len(groups))]
        shown = [(place, value) for place, value in zip(places, values) if value is not None]
        axes.bar(*zip(*shown), width=width, label=label)
    axes.set_xticks(range(len(groups)), groups)
    axes.grid(axis="x", visible=False)


def legend_above(axes, count):
    axes.legend(ncols=count, loc="lower center", bbox_to_anchor=(0.5, 1))


def ratios(results):
    scenes = [name for name, scene in results["scenes"].items() if "bullet" in scene["engines"]]
    figure, axes = plt.subplots(figsize=(9, 3.6))
    series = {}
    for engine in table.present_engines(results):
        of = [results["scenes"][name]["engines"].get(engine) for name in scenes]
        series[table.title(engine)] = [figures and figures["to_bullet"] for figures in of]
    grouped_bars(axes, scenes, series)
    axes.axhline(1, color="black", linewidth=1)
    axes.set_ylabel("step time / Bullet's")
    legend_above(axes, len(series))
    return svg(figure)


def tails(results):
    scenes = list(results["scenes"])
    figure, axes = plt.subplots(figsize=(9, 3.6))
    series = {}
    for engine in ("lockwind", "bullet"):
        for percentile in ("p50_us", "p99_us"):
            of = [results["scenes"][name]["engines"].get(engine) for name in scenes]
            label = f"{engine.capitalize()}, {percentile.removesuffix('_us')}"
            series[label] = [figures and figures[percentile] / 1000 for figures in of]
    grouped_bars(axes, scenes, series)
    axes.set_yscale("log")
    axes.set_ylabel("a step, ms")
    legend_above(axes, len(series))
    return svg(figure)


def growth(results):
    figure, axes = plt.subplots(figsize=(9, 3.6))
    for curve, times in results["growth"]["step_us"].items():
        counts = sorted(times, key=int)
        axes.plot([int(count) for count in counts], [times[count] / 1000 for count in counts],
                  marker="o", label=curve.replace("_", ", "))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("bodies")
    axes.set_ylabel("a step, ms")
    axes.legend()
    return svg(figure)


def phases(results):
    scenes = list(results["phases"])
    figure, axes = plt.subplots(figsize=(9, 0.6 * len(scenes) + 1.2))
    names = list(results["phases"][scenes[0]]["shares"])
    colours = plt.get_cmap("tab20").colors
    left = [0.0] * len(scenes)
    for index, phase in enumerate(names):
        widths = [100 * results["phases"][scene]["shares"][phase] for scene in scenes]
        axes.barh(scenes, widths, left=left, label=phase, color=colours[index % len(colours)])
        left = [a + b for a, b in zip(left, widths)]
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.set_xlabel("share of a step, %")
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return svg(figure)


def snapshots(results):
    scenes = list(results["snapshots"])
    figure, axes = plt.subplots(figsize=(9, 3.6))
    work = ("memcpy", "keep", "restore", "xxh3", "hash", "save", "load")
    grouped_bars(axes, scenes, {
        name: [results["snapshots"][scene][f"{name}_us"] for scene in scenes] for name in work})
    axes.set_yscale("log")
    axes.set_ylabel("us")
    legend_above(axes, len(work))
    return svg(figure)


def rollback(results):
    scenes = list(results["rollback"])
    figure, axes = plt.subplots(figsize=(9, 0.4 * len(scenes) + 1.2))
    axes.barh(scenes, [results["rollback"][scene]["steps"] for scene in scenes])
    axes.axvline(9, color="black", linewidth=1)
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.set_xlabel("times one step; the line is the nine steps themselves")
    return svg(figure)
