#!/usr/bin/env python3
"""Prints how soon meshfront-serve answers after it was started, in milliseconds.

  start_up.py BIN_FOLDER PACK... [--runs 10] [--json]

Each run starts the program on a folder with all the packs named, and takes the time from then until
it says that it listens, until /readyz says that it is ready, and until metadata, base mesh and first
chunk of the last pack have come, asked for one after the other. "first" is the first run, in which
files may come from the disk, the rest is the median of the others. A pack of a large mesh:
write-fractal-sphere and meshfront-encode.
"""
import argparse
import http.client
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

STEPS = ("listening", "ready", "metadata", "base mesh", "first chunk")


def get(port, target):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    try:
        connection.request("GET", target)
        response = connection.getresponse()
        body = response.read()
    finally:
        connection.close()
    if response.status != 200:
        sys.exit(f"start_up: {target} was answered by {response.status}: {body[:200]}")
    return body


def one_start(program, folder, mesh):
    begin = time.monotonic()
    taken = []

    def note():
        taken.append((time.monotonic() - begin) * 1000)

    process = subprocess.Popen([program, "--packs", folder, "--listen", "127.0.0.1:0"],
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        line = process.stdout.readline()
        if "listening on " not in line:
            sys.exit("start_up: the service did not start")
        port = int(line.rsplit(":", 1)[1])
        note()
        get(port, "/readyz")
        note()
        links = json.loads(get(port, f"/v1/meshes/{mesh}"))["links"]
        note()
        get(port, links["base"])
        note()
        get(port, links["chunks"] + "/0")
        note()
    finally:
        process.terminate()
        process.wait()
    return taken


def name_of(bin_folder, pack):
    told = subprocess.run([bin_folder / "meshfront-pack", "info", pack, "--json"],
                          capture_output=True, text=True, check=True)
    return json.loads(told.stdout)["metadata"]["name"]


def main():
    parser = argparse.ArgumentParser(description="How soon the service answers.")
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("packs", type=pathlib.Path, nargs="+")
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    mesh = name_of(options.bin, options.packs[-1])
    with tempfile.TemporaryDirectory(prefix="meshfront-") as folder:
        for number, pack in enumerate(options.packs):
            (pathlib.Path(folder) / f"{number}.pack").symlink_to(pack.resolve())
        runs = [one_start(options.bin / "meshfront-serve", folder, mesh)
                for _ in range(max(2, options.runs))]
    columns = list(zip(*runs))
    table = {step: {"first": column[0], "median": statistics.median(column[1:]),
                    "longest": max(column[1:])} for step, column in zip(STEPS, columns)}
    if options.json:
        print(json.dumps(table, indent=2))
        return
    print(f"| ms until ({len(runs)} starts, {len(options.packs)} packs) | first | median | longest |")
    print("|---|---|---|---|")
    for step, times in table.items():
        print(f"| {step} | " + " | ".join(f"{value:.1f}" for value in times.values()) + " |")


if __name__ == "__main__":
    main()
