#!/usr/bin/env python3
"""Writes index.html and figures.json of an evaluation's folder from what the experiments left there.

  page.py FOLDER

FOLDER/machine.json tells where and when, FOLDER/NAME/status.json how each experiment went; the rest
is read through page_data.py, which refuses a figure without its CSV.
"""

import html
import json
import pathlib
import sys

import page_data
from experiments import EXPERIMENTS, TOPICS

STYLE = pathlib.Path(__file__).with_name("page.css")


def text(value):
    return html.escape(str(value), quote=True)


def number(value):
    """Four significant digits; large ones in full, by thousands."""
    if value is None:
        return "–"
    if isinstance(value, int) or abs(value) >= 10_000:
        return f"{value:,.0f}"
    short = f"{value:.4g}" if abs(value) < 1000 else f"{value:,.0f}"
    return short if "e" not in short else f"{value:.2e}"


def with_unit(value, unit):
    return number(value) + (f" {text(unit)}" if unit and value is not None else "")


def goal_text(row):
    sign = "≤" if row["goal_is"] == "at most" else "≥"
    return f"goal {sign} {number(row['goal'])}"


def verdict_mark(row):
    met = page_data.verdict(row)
    if met is None:
        return ""
    return '<span class="met">met</span>' if met else '<span class="missed">missed</span>'


def unique(values):
    return list(dict.fromkeys(values))


class Folder:
    """An experiment's folder, read and checked."""

    def __init__(self, path):
        self.path = path
        self.name = path.name
        self.figures = page_data.figures(path)
        self.plots = page_data.plots(path)
        self.pictures = page_data.pictures(path)
        status = path / "status.json"
        self.status = json.loads(status.read_text()) if status.is_file() else {}
        for row in self.figures:
            row["folder"] = self.name

    def numbers(self):
        found = unique(row["experiment"] for row in self.figures)
        return found or [n for e in EXPERIMENTS if e.name == self.name for n in e.numbers]

    def topic_of(self, row):
        """Of a plot or picture: what it says itself, else that of figures from the same CSV, else the first."""
        files = {line["csv"] for line in row.get("lines", ())}
        same = [figure["experiment"] for figure in self.figures if figure["csv"] in files]
        return row.get("experiment") or min(same or self.numbers(), default=0)

    def of(self, rows, topic):
        return [row for row in rows if self.topic_of(row) == topic]


def csv_link(row):
    address = f"{row['folder']}/{row['csv']}"
    return f'<a href="{text(address)}">{text(row["csv"])}</a>'


def figure_cell(rows, notes, unit_in_header):
    parts = []
    for row in rows:
        unit = "" if unit_in_header else row["unit"]
        mark = ""
        if row["note"] in notes:
            mark = f'<sup>{notes.index(row["note"]) + 1}</sup>'
        lines = [f'<b>{with_unit(row["value"], unit)}</b>{mark}']
        if row["published"] is not None:
            lines.append(f'<small>published {number(row["published"])}</small>')
        if row["goal"] is not None:
            lines.append(f"<small>{goal_text(row)} {verdict_mark(row)}</small>")
        parts.append("<br>".join(lines))
    return f"<td>{'<hr>'.join(parts)}</td>"


def figure_table(title, rows):
    """One table: rows and columns in the order in which they first come."""
    columns = unique(row["column"] for row in rows)
    units = {c: unique(row["unit"] for row in rows if row["column"] == c) for c in columns}
    notes = unique(row["note"] for row in rows if row["note"])
    of_all = len(notes) == 1 and all(row["note"] for row in rows)
    out = [f"<h3>{text(title)}</h3>", '<div class="wide"><table><thead><tr><th></th>']
    for column in columns:
        unit = f"<br><small>{text(units[column][0])}</small>" if len(units[column]) == 1 and units[column][0] else ""
        out.append(f"<th>{text(column)}{unit}</th>")
    out.append("</tr></thead><tbody>")
    for name in unique(row["row"] for row in rows):
        out.append(f"<tr><th>{text(name)}</th>")
        for column in columns:
            cell = [row for row in rows if (row["row"], row["column"]) == (name, column)]
            out.append(figure_cell(cell, [] if of_all else notes, len(units[column]) == 1) if cell else "<td></td>")
        out.append("</tr>")
    out.append("</tbody></table></div>")
    if of_all:
        out.append(f'<p class="from">{text(notes[0])}</p>')
    elif notes:
        out.append('<ol class="notes">' + "".join(f"<li>{text(note)}</li>" for note in notes) + "</ol>")
    elif all(row["published"] is None for row in rows):
        out.append('<p class="from">Nothing published to stand beside these.</p>')
    links = unique(csv_link(row) for row in rows)
    out.append(f'<p class="from">From {", ".join(links)}.</p>')
    return "\n".join(out)


def plot_figure(folder, plot):
    address = f"{folder.name}/{plot['file']}"
    links = unique(csv_link({"folder": folder.name, "csv": line["csv"]}) for line in plot["lines"])
    caption = text(plot.get("caption") or plot["title"])
    if not (folder.path / f"{plot['file']}.svg").is_file():
        return f'<p class="absent">Not drawn: {caption} From {", ".join(links)}.</p>'
    return (f'<figure><a href="{text(address)}.svg"><img src="{text(address)}.svg" alt="{text(plot["title"])}"></a>'
            f'<figcaption>{caption} <span class="from">From {", ".join(links)}; '
            f'<a href="{text(address)}.png">PNG</a>.</span></figcaption></figure>')


def picture_figure(folder, picture):
    address = text(f"{folder.name}/{picture['file']}")
    caption = text(picture.get("caption", ""))
    return (f'<figure><a href="{address}"><img src="{address}" alt="{caption}"></a>'
            f"<figcaption>{caption}</figcaption></figure>")


def section(topic, folders):
    out = [f'<section id="e{topic}"><h2>{topic}. {text(TOPICS[topic].title)}</h2>',
           f"<p>{text(TOPICS[topic].question)}</p>"]
    for folder in folders:
        rows = [row for row in folder.figures if row["experiment"] == topic]
        for table in unique(row["table"] for row in rows):
            out.append(figure_table(table, [row for row in rows if row["table"] == table]))
        out += [plot_figure(folder, plot) for plot in folder.of(folder.plots, topic)]
        pictures = [picture_figure(folder, picture) for picture in folder.of(folder.pictures, topic)]
        if pictures:
            out.append('<div class="pictures">' + "\n".join(pictures) + "</div>")
    if len(out) == 2:
        out.append(f'<p class="absent">{text(reason_for_absence(topic, folders))}</p>')
    return "\n".join(out) + "</section>"


def reason_for_absence(topic, folders):
    reasons = [folder.status["reason"] for folder in folders if folder.status.get("reason")]
    if reasons:
        return "Did not run to its end: " + "; ".join(reasons)
    if any(topic in e.numbers for e in EXPERIMENTS):
        return "Did not run: it was not among the experiments asked for."
    return "Did not run: there is nothing yet that runs it."


def goals_table(rows):
    """All figures that have a goal, in the order of the experiments."""
    out = ['<section id="goals"><h2>Goals</h2>']
    if not rows:
        return out[0] + "<p>No figure with a goal was taken.</p></section>"
    met = sum(1 for row in rows if page_data.verdict(row))
    open_ones = sum(1 for row in rows if page_data.verdict(row) is None)
    told = f"{met} met, {len(rows) - met - open_ones} missed"
    out.append(f"<p>{told}{f', {open_ones} without a value' if open_ones else ''}.</p>")
    out.append('<div class="wide"><table><thead><tr><th>Experiment</th><th>What</th><th>Ours</th><th>Goal</th>'
               "<th></th><th>Published</th><th>CSV</th></tr></thead><tbody>")
    for row in rows:
        out.append(
            f'<tr><td><a href="#e{row["experiment"]}">{row["experiment"]}. {text(row["table"])}</a></td>'
            f'<td>{text(row["row"])}: {text(row["column"])}</td><td><b>{with_unit(row["value"], row["unit"])}</b></td>'
            f'<td>{goal_text(row).removeprefix("goal ")}</td><td>{verdict_mark(row)}</td>'
            f'<td>{number(row["published"])}</td><td>{csv_link(row)}</td></tr>')
    out.append("</tbody></table></div></section>")
    return "\n".join(out)


def runs_table(folders):
    """How each experiment went; those that did not run are named."""
    seen = {folder.name: folder for folder in folders}
    out = ['<section id="runs"><h2>What was run</h2><div class="wide"><table><thead><tr><th>Experiment</th>'
           "<th>Result</th><th>Seconds</th><th>When</th><th>Command</th></tr></thead><tbody>"]
    for name in unique([e.name for e in EXPERIMENTS] + list(seen)):
        status = seen[name].status if name in seen else {}
        state = status.get("state", "has figures" if name in seen and seen[name].figures else "did not run")
        why = f": {text(status['reason'])}" if status.get("reason") else ""
        log = f' (<a href="{text(name)}/log.txt">log</a>)' if name in seen and (seen[name].path / "log.txt").is_file() else ""
        seconds = number(status["seconds"]) if "seconds" in status else "–"
        out.append(f"<tr><th>{text(name)}</th><td>{text(state)}{why}{log}</td><td>{seconds}</td>"
                   f"<td>{text(status.get('date', '–'))}</td><td><code>{text(status.get('command', '–'))}</code></td></tr>")
    out.append("</tbody></table></div></section>")
    return "\n".join(out)


def head(machine):
    short = ("<p><b>The short form:</b> the bunny alone and few repetitions. It shows that all of it works; "
             "its times tell little.</p>") if machine.get("short") else ""
    facts = "".join(f"<tr><th>{text(key)}</th><td>{text(value)}</td></tr>" for key, value in machine.get("facts", {}).items())
    return f"""<h1>meshfront: the published experiments, repeated</h1>
<p>meshfront streams huge triangle meshes to viewers that decide themselves what they need. Here it stands
beside the other ways to get the same meshes: <b>sender-driven</b> (Kim, Lee and Kobbelt 2004), where a server
keeps a session for each client and decides what it needs; <b>view-independent</b>, where splits come in one
order for everybody; and the <b>whole download</b> of a Draco file. In each table ours is bold, with the
published figure and the goal below it where there are any. Every figure names the CSV that it comes from.</p>
{short}<div class="wide"><table class="facts"><tbody>{facts}</tbody></table></div>
<p>To repeat it, on Debian 12 from a clean checkout of that commit:</p>
<pre>./install-packages.sh
{text(machine.get("repeat", "tests/evaluation/run"))}</pre>"""


def write_page(root):
    machine_file = root / "machine.json"
    machine = json.loads(machine_file.read_text()) if machine_file.is_file() else {}
    folders = [Folder(path) for path in sorted(root.iterdir())
               if path.is_dir() and any((path / name).is_file() for name in ("figures.json", "status.json"))]
    figures = [row for folder in folders for row in folder.figures]
    figures.sort(key=lambda row: row["experiment"])
    unknown = {row["experiment"] for row in figures} - TOPICS.keys()
    if unknown:
        raise page_data.DataError(f"figures of experiments that there are not: {sorted(unknown)}")
    links = "".join(f'<a href="#e{n}">{n}. {text(topic.title)}</a>' for n, topic in TOPICS.items())
    body = [head(machine), f'<nav><a href="#goals">Goals</a>{links}<a href="#runs">What was run</a></nav>',
            goals_table([row for row in figures if row["goal"] is not None])]
    body += [section(n, [f for f in folders if n in f.numbers()]) for n in TOPICS]
    body.append(runs_table(folders))
    (root / "figures.json").write_text(json.dumps(figures, indent=1) + "\n")
    (root / "index.html").write_text(
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>meshfront: evaluation</title><style>{STYLE.read_text()}</style></head>\n<body><main>\n"
        + "\n".join(body) + "\n</main></body></html>\n")


def main():
    if len(sys.argv) != 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    try:
        write_page(pathlib.Path(sys.argv[1]))
    except (page_data.DataError, OSError, ValueError) as error:
        print(f"page: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
