#!/usr/bin/env python3
"""Experiments 1, 2 and 6: what a sender computes, sends and remembers, sender-driven and receiver-driven.

  sender.py --output DIR [--bin build/bin] [--short] MESH...

The sender-driven peer is evaluate-sender's (tests/evaluation/sender_driven), on the same packs as ours.
Our octets are those of meshfront-view and meshfront-serve. Writes DIR/sender: CSV files, PNG files,
figures.json, plots.json and pictures.json.
"""

import csv
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import beside_bench  # noqa: F401  (finds tests/bench)
from encoded_meshes import encode, mesh_name
from experiment_command import experiment_parser
from experiment_files import ExperimentFiles
from sender_figures import tell_all
from served_programs import Server, run

FRAMES = 12
SHORT_FRAMES = 9
VIEWS = ("whole", "half", "close")
SIZE = "500x500"


def camera_path(frames):
    """Once around, nearer on the far side; comes back to where it began."""
    stops = 6
    zooms = (1, 1.4, 2.2, 3, 2.2, 1.4, 1)
    key_frames = [{"time": stop, "camera": f"azimuth={360 * stop // stops};elevation={15 + 10 * (stop % 2)};zoom={zooms[stop]}"}
                  for stop in range(stops)]
    key_frames.append({"time": stops, "camera": f"azimuth=360;elevation=15;zoom={zooms[stops]}"})
    return {"frames_per_second": frames / stops, "key_frames": key_frames, "loop": True, "rounds": 2}


def view(programs, url, *options):
    done = run(programs / "meshfront-view", url, "--headless", "--size", SIZE, "--json", *options)
    if done.returncode != 0:
        sys.exit(f"meshfront-view {url}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def our_bytes(programs, service, mesh, files):
    """What a receiver of ours gets and sends, by view; "all" is the whole mesh. Returns octets of an answer's headers."""
    for name in ("all", *VIEWS):
        options = ("--camera", "whole", "--until", "complete") if name == "all" else ("--camera", name)
        told = view(programs, f"{service.url}/v1/meshes/{mesh}", *options)
        files.add("our_bytes.csv", {
            "mesh": mesh, "view": name, "records": told["records"], "requests": told["requests"],
            "bytes_up": told["bytes_up"], "bytes_down": told["bytes_down"], "header_bytes_down": told["header_bytes_down"],
            "id_bits_a_record": round(8 * told["set_octets"] / max(told["records"], 1), 3),
            "record_bits_a_record": round(8 * told["record_bytes_down"] / max(told["records"], 1), 3)})
    return told["header_bytes_down"] / told["http_requests"]


def our_walk(programs, service, mesh, path, folder, files):
    """Our octets along the path, frame by frame, each settled."""
    log = folder / f"{mesh}-walk.csv"
    done = run(programs / "meshfront-view", f"{service.url}/v1/meshes/{mesh}", "--headless", "--size", SIZE, "--path", path,
               "--path-pace", "settled", "--path-log", log, "--json")
    if done.returncode != 0:
        sys.exit(f"meshfront-view --path: {done.stderr.strip()}")
    with log.open(newline="") as lines:
        for row in csv.DictReader(lines):
            files.add("our_walk.csv", {"mesh": mesh, "frame": row["frame"], "bytes_up": row["bytes_up"],
                                       "bytes_down": row["bytes_down"], "triangles": row["triangles"]})


def main():
    options = experiment_parser(__doc__, "sender").parse_args()
    output = options.output / "sender"
    files = ExperimentFiles(output)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        packs = folder / "packs"
        packs.mkdir()
        path = folder / "walk.json"
        path.write_text(json.dumps(camera_path(SHORT_FRAMES if options.short else FRAMES)))
        names = []
        for mesh in options.meshes:
            names.append(mesh_name(mesh))
            encode(options.bin, mesh, packs / f"{names[-1]}.pack")
        headers = []
        with Server(options.bin / "meshfront-serve", "--packs", packs, "--listen", "127.0.0.1:0") as service:
            for name in names:
                started = time.monotonic()
                headers.append(our_bytes(options.bin, service, name, files))
                our_walk(options.bin, service, name, path, folder, files)
                print(f"{name}, ours over HTTP: {time.monotonic() - started:.1f} s", flush=True)
        files.write()
        command = [options.bin / "evaluate-sender", *(packs / f"{name}.pack" for name in names), "--path", path, "--output",
                   output, "--header-bytes", statistics.mean(headers), *(["--short"] if options.short else [])]
        if subprocess.run([str(part) for part in command], check=False).returncode != 0:
            return 1
    tell_all(files, output, names)
    return 0


if __name__ == "__main__":
    sys.exit(main())
