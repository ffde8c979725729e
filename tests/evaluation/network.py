#!/usr/bin/env python3
"""Experiment 9: how long each way takes to 35 dB and to its end, over links of several round trips and
bandwidths.

  network.py --output DIR [--bin build/bin] [--results DIR] [--short] MESH...

The whole mesh in 500x500 pixels. What sender-driven and view-independent streaming need for 35 dB is
taken from DIR/quality_against_bytes/bytes_to_psnr.csv (experiment 3); without it they are left out. links.py
tells how the link is made. At the longest round trip each way is timed twice; the shorter time counts.
Writes DIR/network: network.csv, links.csv, figures.json and plots.json.
"""

import contextlib
import csv
import json
import pathlib
import shutil
import sys
import tempfile
import time

import beside_bench  # noqa: F401  (finds tests/bench)
import links
from encoded_meshes import encode, mesh_name, succeed
from experiment_command import experiment_parser
from experiment_files import ExperimentFiles
from served_programs import run
from timed_ways import TARGET, CameraFirst, Draco, Pipe, ReceiverDriven, SenderDriven

ROUND_TRIPS = (5, 50, 200)  # ms
MEGABITS = (1, 10, 100)
GOAL = 1.5  # of the time of sender-driven streaming, at 200 ms
BITS = 14

OURS = ("meshfront-view --live from meshfront-serve: connection, metadata, base mesh, records; counting pixels on the CPU "
        "and decoding are in it, drawing for the PSNR is not (the records that 35 dB take are learnt by a run before).")


SENDER = ("sender-driven-client from sender-driven-server over one connection, timed at the octets that 35 dB take in "
          "experiment 3; nothing is drawn.")
PIPE = "Download of as many octets as 35 dB take in experiment 3; decoding is not in it."
FILE = "Download, then draco_decoder's own time."
FIRST = "As sender-driven, but the camera is sent with the connection, not when the base mesh has come."
NOTES = {ReceiverDriven.label: OURS, SenderDriven.label: SENDER, CameraFirst.label: FIRST, Pipe.label: PIPE, Draco.label: FILE}
NO_LINK = "without a link"


def needed(results, mesh, way):
    """(octets, records) that `way` takes to the target, as experiment 3 found; None: it did not tell."""
    path = results / "quality_against_bytes" / "bytes_to_psnr.csv" if results else None
    if path is None or not path.is_file():
        return None
    with path.open(newline="") as lines:
        for row in csv.DictReader(lines):
            if (row["mesh"], row["view"], row["way"], float(row["psnr"])) == (mesh, "whole", way, TARGET):
                return int(float(row["bytes"])), int(float(row["records"]))
    return None


def times_of(rtt):
    """How often a way is timed, the better one counting: other work on the machine takes time too, and at
    this round trip there is a goal."""
    return 2 if rtt == max(ROUND_TRIPS) else 1


def ways_of(mesh, options, folder, stack):
    """The ways that can be timed here, each started."""
    name = mesh_name(mesh)
    packs, files = folder / "packs", folder / "files"
    packs.mkdir()
    files.mkdir()
    pack = packs / f"{name}.pack"
    encode(options.bin, mesh, pack, "--quantization", BITS)
    metadata = json.loads(succeed(options.bin / "meshfront-pack", "info", pack, "--json"))["metadata"]
    ways = [ReceiverDriven(options.bin, packs, mesh)]
    target = needed(options.results, name, "sender")
    if target and (options.bin / "sender-driven-server").is_file():
        ways += [way(options.bin, pack, target[0]) for way in (SenderDriven, CameraFirst)]
    target = needed(options.results, name, "view-independent")
    if target:
        ways.append(Pipe(files, target[0], metadata["baseBytes"] + metadata["recordBytes"]))
    if shutil.which("draco_encoder"):
        plain = folder / "plain.ply"
        if run(options.bin / "write-plain-ply", mesh, plain).returncode != 0:
            sys.exit("write-plain-ply failed")
        ways.append(Draco(files, plain, BITS))
    return [stack.enter_context(way) for way in ways]


def time_mesh(mesh, cells, options, files):
    name = mesh_name(mesh)
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        ways = ways_of(mesh, options, pathlib.Path(folder), stack)
        for rtt, mbit in cells:
            begin = time.monotonic()
            for way in ways:
                timing = min((way.time(rtt, mbit) for _ in range(times_of(rtt))), key=lambda timing: timing["to_target"])
                files.add("network.csv", {
                    "mesh": name, "way": way.label, "rtt_ms": rtt or 0, "mbit": mbit or "",
                    "to_35_db_s": round(timing["to_target"], 4), "settled_s": round(timing["settled"], 4),
                    **{key: timing.get(key, "") for key in ("bytes", "records", "requests")}})
            print(f"{name}, {cell_name(rtt, mbit)}: {time.monotonic() - begin:.1f} s", flush=True)


def cell_name(rtt, mbit):
    return NO_LINK if not rtt else f"{rtt} ms, {mbit} Mbit/s"


def tell_links(cells, files):
    for rtt, mbit in cells:
        if rtt is None:
            continue
        found = links.measured(rtt, mbit)
        row = {"rtt_ms": rtt, "mbit": mbit, "measured_rtt_ms": round(1e3 * found["round_trip"], 2),
               "measured_mbit": round(found["rate"] * 8e-6, 3), "setup_and_answer_ms": round(1e3 * found["setup"], 2)}
        files.add("links.csv", row)
        where = {"table": "The links, as measured", "row": cell_name(rtt, mbit), "csv": "links.csv"}
        files.figure(9, **where, column="round trip", value=row["measured_rtt_ms"], unit="ms", note=f"Made by {links.kind()}.")
        files.figure(9, **where, column="bandwidth", value=row["measured_mbit"], unit="Mbit/s")
        files.figure(9, **where, column="first answer of a new connection", value=row["setup_and_answer_ms"], unit="ms")


def tell(files, name):
    rows = [row for row in files.rows("network.csv") if row["mesh"] == name]
    for row in rows:
        where = {"row": cell_name(row["rtt_ms"], row["mbit"]), "column": row["way"], "unit": "s", "csv": "network.csv"}
        files.figure(9, table=f"Seconds to 35 dB: {name}, whole", **where, value=row["to_35_db_s"], note=NOTES[row["way"]])
        files.figure(9, table=f"Seconds until all that is seen is there: {name}, whole", **where, value=row["settled_s"])
    seconds = {(row["way"], row["rtt_ms"], row["mbit"]): row["to_35_db_s"] for row in rows}
    for (way, rtt, mbit), taken in seconds.items():
        for beside in (SenderDriven.label, CameraFirst.label):
            if way != ReceiverDriven.label or not rtt or (beside, rtt, mbit) not in seconds:
                continue
            goal = {"goal": GOAL, "goal_is": "at most"} if rtt == 200 else {}
            files.figure(9, table=f"Time to 35 dB, receiver-driven / {beside}", row=cell_name(rtt, mbit), column=name,
                         value=round(taken / seconds[beside, rtt, mbit], 3), unit="ratio", csv="network.csv",
                         note="Not published; the goal is our own.", **goal)
    for mbit in sorted({row["mbit"] for row in rows if row["rtt_ms"]}):
        files.plot(f"seconds_{name}_{mbit}", f"{name}: seconds to 35 dB at {mbit} Mbit/s", "round trip, ms", "seconds to 35 dB", [
            {"label": way, "csv": "network.csv", "where": {"mesh": name, "way": way, "mbit": mbit}, "x_column": "rtt_ms",
             "y_column": "to_35_db_s"} for way in dict.fromkeys(row["way"] for row in rows)],
            caption=f"Time to 35 dB by round trip at {mbit} Mbit/s each way, {name} as a whole.", log_x=True, log_y=True)


def main():
    arguments = experiment_parser(__doc__, "network")
    arguments.add_argument("--results", type=pathlib.Path, metavar="DIR", help="of the other experiments")
    options = arguments.parse_args()
    cells = [(None, None)] + [(rtt, mbit) for rtt in ROUND_TRIPS for mbit in MEGABITS]
    if options.short:
        cells = [(None, None), (50, 10)]
    print(f"links made by {links.kind()}", flush=True)
    files = ExperimentFiles(options.output / "network")
    tell_links(cells, files)
    for mesh in options.meshes:
        time_mesh(mesh, cells, options, files)
        tell(files, mesh_name(mesh))
    files.write()
    return 0


if __name__ == "__main__":
    links.enter_namespace()
    sys.exit(main())
