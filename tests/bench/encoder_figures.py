#!/usr/bin/env python3
"""Prints the encoder's figures beside its peers', measured side by side in one run.

  encoder_figures.py [--bin build/bin] [--runs 3] [--only speed whole quality] FOLDER-OR-MESH...

  speed     simplification alone: ours, OpenMesh's decimater, meshoptimizer (simplification-bench)
  whole     from file to file: meshfront-encode, draco_encoder -cl 10 -qp 14; time, memory, bytes
  quality   distances to the input at 20 %, 5 % and 1 % of the vertices (simplification-quality)

A folder stands for its meshes among bunny, horse, igea, gcanyon600, gcanyon1200 and fandisk, .xz
or not; gcanyon1200 is left out of the quality, where it takes long. Runs are interleaved, medians
are told. Draco's bits are those of a mesh that comes whole, in no order: a bound, not a rival.
"""

import argparse
import json
import lzma
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

KNOWN = ["fandisk.obj", "bunny.ply", "horse.ply", "igea.ply", "gcanyon600.ply", "gcanyon1200.ply"]


def meshes_of(places, work):
    """The mesh files, unpacked into `work` where they are compressed."""
    found = []
    for place in places:
        if place.is_file():
            candidates = [place]
        else:
            candidates = [place / name for name in KNOWN]
            candidates += [place / f"{name}.xz" for name in KNOWN if not (place / name).exists()]
        for path in candidates:
            if not path.exists():
                continue
            if path.suffix == ".xz":
                plain = work / path.stem
                with lzma.open(path) as packed, plain.open("wb") as unpacked:
                    shutil.copyfileobj(packed, unpacked)
                path = plain
            found.append(path)
    if not found:
        sys.exit("encoder_figures: no mesh found in " + ", ".join(map(str, places)))
    return sorted(found, key=lambda path: path.stat().st_size)


def timed(*command):
    started = time.monotonic()
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    seconds = time.monotonic() - started
    if done.returncode != 0:
        sys.exit(f"{command[0]}: {done.stderr or done.stdout}")
    return seconds, done.stdout


def print_table(header, rows):
    print("| " + " | ".join(header) + " |")
    print("|---" * len(header) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print(flush=True)


def whole(programs, meshes, runs, work):
    """Both encoders from file to file, in turn, from the same plain PLY."""
    draco = shutil.which("draco_encoder")
    if not draco:
        print("draco_encoder is not installed (./install-packages.sh bench); only ours is told\n")
    rows = []
    for mesh in meshes:
        pack, drc = work / f"{mesh.stem}.pack", work / f"{mesh.stem}.drc"
        plain = work / f"{mesh.stem}-plain.ply"  # Draco reads no strips and no doubles
        timed(programs / "write-plain-ply", mesh, plain)
        ours, theirs, report = [], [], None
        for _ in range(runs):
            seconds, out = timed(programs / "meshfront-encode", plain, "--output", pack, "--json")
            ours.append(seconds)
            report = json.loads(out)
            if draco:
                seconds, _ = timed(draco, "-i", plain, "-o", drc, "-cl", 10, "-qp", 14)
                theirs.append(seconds)
        vertices = report["metadata"]["vertexCount"]
        bytes_ours = report["metadata"]["baseBytes"] + report["metadata"]["chunkBytes"]
        peak = max(phase["peakMiB"] for phase in report["phases"])
        seconds_ours = statistics.median(ours)
        row = [
            mesh.stem, str(vertices), f"{seconds_ours:.2f}", f"{peak:.0f}", f"{report['estimatedPeakMiB']:.0f}",
            str(bytes_ours), f"{8 * bytes_ours / vertices:.2f}", f"{report['bitsPerSplit']['total']:.2f}",
        ]
        if draco:
            seconds_theirs, bytes_theirs = statistics.median(theirs), drc.stat().st_size
            row += [
                f"{seconds_theirs:.2f}", str(bytes_theirs), f"{8 * bytes_theirs / vertices:.2f}",
                f"{seconds_ours / seconds_theirs:.2f}", f"{bytes_ours / bytes_theirs:.2f}",
            ]
        else:
            row += ["-"] * 5
        rows.append(row)
        pack.unlink()
        plain.unlink()
    print("From file to file (s: median; bytes: base and chunks, with their directories)\n")
    print_table(
        ["mesh", "vertices", "ours s", "peak MiB", "estimated", "bytes", "bits/vertex", "bits/split",
         "Draco s", "bytes", "bits/vertex", "time ours/Draco", "bytes ours/Draco"],
        rows,
    )


def peers(programs, name, meshes, *options):
    program = programs / name
    if not program.exists():
        print(f"{program} is not built: it needs libmeshoptimizer-dev (./install-packages.sh bench), then cmake\n")
        return
    for mesh in meshes:
        print(timed(program, mesh, *options)[1], flush=True)


def main():
    arguments = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    arguments.add_argument("places", nargs="+", type=pathlib.Path, metavar="FOLDER-OR-MESH")
    arguments.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/bin"))
    arguments.add_argument("--runs", type=int, default=3)
    arguments.add_argument("--only", nargs="+", choices=["speed", "whole", "quality"],
                           default=["speed", "whole", "quality"])
    options = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        meshes = meshes_of(options.places, work)
        if "speed" in options.only:
            print("Simplification alone, processor time, from the cleaned mesh on\n")
            peers(options.bin, "simplification-bench", meshes, "--runs", options.runs)
        if "whole" in options.only:
            whole(options.bin, meshes, options.runs, work)
        if "quality" in options.only:
            print("Distances to the input\n")
            peers(options.bin, "simplification-quality", [m for m in meshes if m.stem != "gcanyon1200"])
    return 0


if __name__ == "__main__":
    sys.exit(main())
