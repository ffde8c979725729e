#!/usr/bin/env python3
"""Draws each plot that an experiment's plots.json describes, as SVG and PNG beside it.

  plots.py FOLDER...
"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({
    "svg.hashsalt": "meshfront", "svg.fonttype": "path", "font.size": 11, "axes.grid": True,
    "grid.color": "#dddddd", "axes.edgecolor": "#888888", "axes.spines.top": False, "axes.spines.right": False,
})
from matplotlib import pyplot  # noqa: E402
from matplotlib.ticker import FuncFormatter  # noqa: E402

import page_data  # noqa: E402

# Told apart by colour-blind people too, and by their dashes in print.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555", "#000000")
DASHES = ("-", "--", "-.", ":")
MOST_MARKED = 30  # points of a line that are marked one by one


def in_words(value, _):
    for size, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= size:
            return f"{value / size:g} {letter}"
    return f"{value:g}"


def draw(folder, plot):
    figure, axes = pyplot.subplots(figsize=(7.2, 4.5), layout="constrained")
    for number, line in enumerate(plot["lines"]):
        points = page_data.line_points(folder, line)
        axes.plot([x for x, _ in points], [y for _, y in points], label=line["label"], linewidth=1.8,
                  color=COLOURS[number % len(COLOURS)], linestyle=DASHES[number // 2 % len(DASHES)],
                  marker="o" if len(points) <= MOST_MARKED else None, markersize=4)
    for axis, name, log in ((axes.xaxis, "x", plot.get("log_x")), (axes.yaxis, "y", plot.get("log_y"))):
        if log:
            (axes.set_xscale if name == "x" else axes.set_yscale)("log")
        axis.set_major_formatter(FuncFormatter(in_words))
        axis.set_label_text(plot[name])
    if "y_most" in plot:
        axes.set_ylim(top=min(axes.get_ylim()[1], plot["y_most"]))
    axes.set_title(plot["title"], fontsize=12)
    if len(plot["lines"]) > 1:
        axes.legend(frameon=False, fontsize=9)
    figure.savefig(folder / f"{plot['file']}.svg", metadata={"Date": None})
    figure.savefig(folder / f"{plot['file']}.png", dpi=110)
    pyplot.close(figure)


def main():
    for name in sys.argv[1:]:
        folder = pathlib.Path(name)
        try:
            for plot in page_data.plots(folder):
                draw(folder, plot)
        except page_data.DataError as error:
            sys.exit(f"plots: {error}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
