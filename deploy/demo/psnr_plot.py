"""A plot of picture quality against bytes received, as an SVG element for a page."""

import csv
import html
import math

WIDTH, HEIGHT = 760, 360
LEFT, RIGHT, TOP, BOTTOM = 56, 20, 24, 48
LABEL_WIDTH = 60


class Series:
    def __init__(self, name, css_class, points):
        self.name = name
        self.css_class = css_class  # gives the colour
        self.points = points  # (bytes down, dB), ascending


def points_of(trace_path):
    """The points of a trace as meshfront-view writes it."""
    with open(trace_path, newline="", encoding="ascii") as file:
        rows = [row for row in csv.DictReader(file) if row["psnr"]]
    return [(int(row["bytes_down"]), float(row["psnr"])) for row in rows]


def round_step(span, parts):
    """1, 2 or 5 times a power of ten: the step that cuts `span` into about `parts`."""
    raw = span / parts
    power = 10 ** math.floor(math.log10(raw))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= raw)


def plot(series, marks, target):
    """`marks`: (bytes, dB, label) of the pictures. `target`: dB, drawn as a line."""
    everything = [p for s in series for p in s.points] + [(x, y) for x, y, _ in marks]
    x_step = round_step(max(x for x, _ in everything) / 1000, 8) * 1000
    x_end = math.ceil(max(x for x, _ in everything) / x_step) * x_step
    y_begin = math.floor(min(y for _, y in everything) / 5) * 5
    y_end = math.ceil(max(y for _, y in everything) / 5) * 5

    def px(x):
        return LEFT + (WIDTH - LEFT - RIGHT) * x / x_end

    def py(y):
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (y - y_begin) / (y_end - y_begin)

    out = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
           'aria-label="Picture quality against kilobytes received">']
    for i in range(round(x_end / x_step) + 1):
        x = i * x_step
        out.append(f'<line class="grid" x1="{px(x):.1f}" x2="{px(x):.1f}" y1="{TOP}" '
                   f'y2="{HEIGHT - BOTTOM}"/><text x="{px(x):.1f}" y="{HEIGHT - BOTTOM + 18}" '
                   f'text-anchor="middle">{x / 1000:g}</text>')
    for y in range(y_begin, y_end + 1, 5):
        out.append(f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{py(y):.1f}" '
                   f'y2="{py(y):.1f}"/><text x="{LEFT - 8}" y="{py(y) + 4:.1f}" '
                   f'text-anchor="end">{y}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 8}" '
               'text-anchor="middle">kB received, headers included</text>')
    out.append(f'<text transform="translate(14 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" '
               'text-anchor="middle">PSNR, dB</text>')
    out.append(f'<line class="target" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{py(target):.1f}" '
               f'y2="{py(target):.1f}"/>')
    for s in series:
        line = " ".join(f"{px(x):.1f},{py(y):.1f}" for x, y in s.points)
        out.append(f'<polyline class="{s.css_class}" points="{line}"/>')
    label_end = label_y = -math.inf
    for x, y, label in sorted(marks):
        out.append(f'<circle class="mark" cx="{px(x):.1f}" cy="{py(y):.1f}" r="5"/>')
        if px(x) < LEFT + 80:  # no room between it and the axis
            at, up, anchor = px(x) + 10, py(y) + 4, "start"
        else:  # above, where a rising curve leaves room; over the last label if that is near
            at, up, anchor = px(x) - 8, py(y) - 8, "end"
            if at - LABEL_WIDTH < label_end:
                up = min(up, label_y - 15)
            label_end, label_y = at, up
        out.append(f'<text x="{at:.1f}" y="{up:.1f}" text-anchor="{anchor}">'
                   f'{html.escape(label)}</text>')
    for i, s in enumerate(series):
        y = HEIGHT - BOTTOM - 14 - 20 * (len(series) - 1 - i)
        out.append(f'<line class="{s.css_class}" x1="{WIDTH - 330}" x2="{WIDTH - 302}" y1="{y}" '
                   f'y2="{y}"/><text x="{WIDTH - 294}" y="{y + 4}">{html.escape(s.name)}</text>')
    out.append("</svg>")
    return "\n".join(out)
