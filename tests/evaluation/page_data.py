"""What an experiment has left in its folder: figures, plots and pictures, each checked to stand on a
CSV that is there. README.md describes the files."""

import csv
import json
import math
import re

FIGURE_KEYS = {"experiment", "table", "row", "column", "value", "unit", "published", "goal", "goal_is", "csv", "note"}
PLOT_KEYS = {"file", "title", "x", "y", "lines"}
LINE_KEYS = {"label", "csv", "x_column", "y_column"}
SAFE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


class DataError(Exception):
    """A folder that does not keep to the format, with what is wrong in it."""


def read_list(folder, name):
    path = folder / name
    if not path.is_file():
        return []
    try:
        rows = json.loads(path.read_text())
    except ValueError as error:
        raise DataError(f"{path}: {error}") from error
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise DataError(f"{path}: not a list of objects")
    return rows


def safe_name(text, where):
    if not isinstance(text, str) or not SAFE_NAME.fullmatch(text):
        raise DataError(f"{where}: {text!r} is no plain file name")
    return text


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def check_csv(folder, name, where):
    path = folder / safe_name(name, where)
    if not path.is_file():
        raise DataError(f"{where}: there is no {path}")
    with path.open() as lines:
        if next(lines, "").strip() == "" or next(lines, "").strip() == "":
            raise DataError(f"{where}: {path} holds no data")


def check_figure(folder, row, where):
    missing = FIGURE_KEYS - row.keys()
    if missing:
        raise DataError(f"{where}: without {', '.join(sorted(missing))}")
    for key in ("value", "published", "goal"):
        if row[key] is not None and not is_number(row[key]):
            raise DataError(f"{where}: {key} is {row[key]!r}, neither a number nor null")
    if row["goal"] is not None and row["goal_is"] not in ("at most", "at least"):
        raise DataError(f"{where}: goal_is {row['goal_is']!r} with the goal {row['goal']!r}")
    if not isinstance(row["experiment"], int):
        raise DataError(f"{where}: experiment is no number")
    check_csv(folder, row["csv"], where)


def figures(folder):
    """The rows of figures.json, checked."""
    rows = read_list(folder, "figures.json")
    for number, row in enumerate(rows):
        check_figure(folder, row, f"{folder.name}/figures.json, row {number}")
    return rows


def plots(folder):
    """The rows of plots.json, checked; line_points() reads what is to be drawn."""
    rows = read_list(folder, "plots.json")
    for number, row in enumerate(rows):
        where = f"{folder.name}/plots.json, row {number}"
        if PLOT_KEYS - row.keys():
            raise DataError(f"{where}: without {', '.join(sorted(PLOT_KEYS - row.keys()))}")
        safe_name(row["file"], where)
        for line in row["lines"]:
            if LINE_KEYS - line.keys():
                raise DataError(f"{where}: a line without {', '.join(sorted(LINE_KEYS - line.keys()))}")
            check_csv(folder, line["csv"], where)
    return rows


def pictures(folder):
    """The rows of pictures.json; each file is there."""
    rows = read_list(folder, "pictures.json")
    for number, row in enumerate(rows):
        where = f"{folder.name}/pictures.json, row {number}"
        if not (folder / safe_name(row.get("file"), where)).is_file():
            raise DataError(f"{where}: there is no {folder / row['file']}")
    return rows


def line_points(folder, line):
    """[(x, y)] of a plot's line, in the order of the CSV. A cell that is empty is left out."""
    where = line.get("where", {})
    path = folder / line["csv"]
    points = []
    with path.open(newline="") as lines:
        reader = csv.DictReader(lines)
        columns = set(reader.fieldnames or [])
        for column in (*where, line["x_column"], line["y_column"]):
            if column not in columns:
                raise DataError(f"{path} has no column '{column}'")
        for row in reader:
            if any(row[key] != str(value) for key, value in where.items()):
                continue
            if row[line["x_column"]] and row[line["y_column"]]:
                points.append((float(row[line["x_column"]]), float(row[line["y_column"]])))
    if not points:
        raise DataError(f"{path} has no rows where {where}")
    return points


def verdict(row):
    """True where the goal is met, False where it is missed, None without a goal or a value."""
    if row["goal"] is None or row["value"] is None:
        return None
    return row["value"] <= row["goal"] if row["goal_is"] == "at most" else row["value"] >= row["goal"]
