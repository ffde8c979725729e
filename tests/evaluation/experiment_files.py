"""What an experiment leaves behind: CSV files, figures.json and plots.json (README.md), written together
at the end so that a figure never stands there without its data."""

import csv
import json


class ExperimentFiles:
    def __init__(self, folder):
        self.folder = folder
        self.tables = {}
        self.figures = []
        self.plots = []
        folder.mkdir(parents=True, exist_ok=True)

    def add(self, name, row):
        """A row of a CSV; the first one gives the columns."""
        self.tables.setdefault(name, []).append(row)

    def rows(self, name):
        return self.tables.get(name, [])

    def figure(self, experiment, *, table, row, column, value, unit, csv, note="", published=None, goal=None, goal_is=None):
        self.figures.append({"experiment": experiment, "table": table, "row": row, "column": column, "value": value,
                             "unit": unit, "published": published, "goal": goal, "goal_is": goal_is, "csv": csv,
                             "note": note})

    def plot(self, file, title, x, y, lines, caption, **settings):
        self.plots.append({"file": file, "title": title, "x": x, "y": y, "lines": lines, "caption": caption} | settings)

    def write(self):
        for name, rows in self.tables.items():
            with (self.folder / name).open("w", newline="") as out:
                writer = csv.DictWriter(out, rows[0].keys(), lineterminator="\n")
                writer.writeheader()
                writer.writerows(rows)
        for name, rows in (("plots.json", self.plots), ("figures.json", self.figures)):
            (self.folder / name).write_text(json.dumps(rows, indent=1) + "\n")
