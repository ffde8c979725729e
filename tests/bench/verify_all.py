#!/usr/bin/env python3
"""Encodes mesh files and proves each pack exact; one line a mesh.

  verify_all.py [--bin build/bin] [--orders 12] MESH...

A line tells what the encoder read, how long it took, and what meshfront-pack verify says of the
pack. A mesh that the encoder refuses is right only if its name starts with "vanishes-" (no triangle
is left of it). Exit status 1 if one of them is wrong. The nasty meshes of the tests:

  build/bin/write-nasty-meshes /tmp/nasty && tests/bench/verify_all.py /tmp/nasty/*.ply
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile


def run(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True)


def check(programs, mesh, pack, orders):
    """What is printed of a mesh, and whether it is right."""
    encoded = run(programs / "meshfront-encode", mesh, "--output", pack, "--name", "mesh", "--json")
    if encoded.returncode != 0:
        message = encoded.stderr.strip().splitlines()
        refused = encoded.returncode == 1 and mesh.name.startswith("vanishes-")
        return f"refused     {message[-1] if message else encoded.returncode}", refused
    report = json.loads(encoded.stdout)
    metadata = report["metadata"]
    seconds = sum(phase["seconds"] for phase in report["phases"])
    verified = run(programs / "meshfront-pack", "verify", pack, "--against", mesh, "--orders", orders, "--json")
    exact = False
    said = verified.stderr.strip()
    if verified.returncode in (0, 1) and verified.stdout:
        answer = json.loads(verified.stdout)
        fronts = sum(order["fronts"] for order in answer["orders"])
        exact = verified.returncode == 0 and answer["exact"] and len(answer["orders"]) == orders
        said = f"{orders} orders, {fronts} fronts"
    bits = report["bitsPerSplit"]["total"]
    return (
        f"{'exact' if exact else 'NOT EXACT':<11} {metadata['vertexCount']:>9} vertices"
        f" {metadata['triangleCount']:>9} triangles {bits:6.2f} bits a split {seconds:7.2f} s, {said}",
        exact,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/bin"))
    parser.add_argument("--orders", type=int, default=12)
    parser.add_argument("meshes", type=pathlib.Path, nargs="+", metavar="MESH")
    options = parser.parse_args()
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for mesh in options.meshes:
            line, right = check(options.bin, mesh, pathlib.Path(folder) / "mesh.pack", options.orders)
            wrong += 0 if right else 1
            print(f"{mesh.name:<42} {line}", flush=True)
    print(f"{len(options.meshes) - wrong} of {len(options.meshes)} are right")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
