#!/usr/bin/env python3
"""tests/evaluation/run --short: every experiment runs, and the page is complete.

  evaluation_short_test.py BUILD_FOLDER
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

from experiments import EXPERIMENTS, TOPICS

RUN = pathlib.Path(__file__).with_name("run")


def problems(root):
    page = (root / "index.html").read_text()
    figures = json.loads((root / "figures.json").read_text())
    for number in sorted({n for e in EXPERIMENTS for n in e.numbers}):
        if not any(row["experiment"] == number and row["value"] is not None for row in figures):
            yield f"experiment {number} ({TOPICS[number].title}) has no figure"
    for experiment in EXPERIMENTS:
        state = json.loads((root / experiment.name / "status.json").read_text())["state"]
        if state != "done":
            yield f"{experiment.name}: {state}"
    if "Not drawn" in page:
        yield "a plot was not drawn"
    for address in re.findall(r'(?:src|href)="([^"#]+)"', page):
        if not (root / address).is_file():
            yield f"{address} is linked and not there"
    for plot in root.glob("*/plots.json"):
        for row in json.loads(plot.read_text()):
            for ending in ("svg", "png"):
                if not (plot.parent / f"{row['file']}.{ending}").stat().st_size:
                    yield f"{plot.parent.name}/{row['file']}.{ending} is empty"


def main():
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, RUN, "--short", "--no-build", "--build", sys.argv[1], "--output", folder])
        if done.returncode != 0:
            for log in sorted(pathlib.Path(folder).glob("*/log.txt")):
                print(f"-- {log.parent.name}\n{log.read_text(errors='replace')[-2000:]}")
            return 1
        found = list(problems(pathlib.Path(folder)))
    for problem in found:
        print(problem)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
