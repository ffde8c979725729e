#!/usr/bin/env python3
"""Prints what the viewer holds and costs: loops, restarts, budgets, frame times, a lost server.

  viewer_figures.py BIN_FOLDER MESH [--parts loop restart flight frames lost scene]
                    [--seconds 180] [--seed 1] [--keep FOLDER]

For a mesh file, which is encoded and served:
  loop     two rounds about it, each frame settled: bytes of each round
  restart  a view settled with a disk cache, by a second viewer again, and without a service
  flight   a random flight of --seconds under a budget of triangles and one of memory: their peaks
  frames   a window (llvmpipe under xvfb): pictures while all of the mesh arrives, and at rest
  lost     a window whose server stops for 20 s in mid-refinement: what its panel said
  scene    three of the mesh, one turned and one small, in one scene
A line of Markdown for each figure. --keep leaves scripts, logs and pictures in a folder. Exit
status 1 if something is not as it must be: bytes in the second round or for the restart, a budget
exceeded, a run that does not settle.
"""

import argparse
import contextlib
import csv
import json
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

from served_programs import Server, run

XVFB = ("xvfb-run", "-a", "-s", "-screen 0 1280x720x24")
failures = []


def tell(name, text, good=True):
    print(f"| {name} | {text} |", flush=True)
    if not good:
        failures.append(name)


def viewer(options, *arguments):
    """The summary of a headless run."""
    done = run(options.bin / "meshfront-view", *arguments, "--headless", "--json")
    if not done.stdout:
        sys.exit(f"meshfront-view {' '.join(map(str, arguments))}: {done.stderr}")
    return json.loads(done.stdout.splitlines()[-1])


def rows(log):
    with open(log) as file:
        return list(csv.DictReader(file))


def loop(options, url):
    path = options.folder / "loop.json"
    frames = [{"time": t, "camera": f"azimuth={90 * t};elevation=15"} for t in range(5)]
    path.write_text(json.dumps({"frames_per_second": 4, "key_frames": frames, "interpolation": "linear",
                                "loop": True, "rounds": 2}))
    log = options.folder / "loop.csv"
    viewer(options, url, "--size", "640x480", "--path", path, "--path-pace", "settled", "--path-log", log,
           "--triangle-budget", 3 * options.triangles)
    table = rows(log)
    half = len(table) // 2
    first = int(table[half - 1]["bytes_down"])
    second = int(table[-1]["bytes_down"]) - first
    again = int(table[-1]["resplits"])
    tell("two rounds", f"{first:,} bytes in the first, {second:,} in the second; {again:,} splits from what was "
         f"kept, {int(table[-1]['collapses']):,} collapses", second == 0)


def restart(options, url, server):
    cache = options.folder / "cache"
    arguments = (url, "--size", "640x480", "--cache-dir", cache)
    first = viewer(options, *arguments)
    second = viewer(options, *arguments)
    fresh = second["records"] - second["records_from_disk"]
    server.process.send_signal(signal.SIGSTOP)
    stopped = viewer(options, *arguments, "--timeout", "25")
    server.process.send_signal(signal.SIGCONT)
    tell("restart from disk",
         f"{first['record_bytes_down']:,} bytes of records at first, {second['record_bytes_down']:,} again; "
         f"{second['records_from_disk']:,} records from disk, {fresh:,} that the first had not asked for; "
         f"{second['state']} after {second['seconds']:.1f} s",
         fresh < 0.01 * second["records"] and second["state"] == "settled")
    tell("the same, server silent", f"{stopped['records_from_disk']:,} records from disk, {stopped['triangles']:,} "
         f"triangles: {stopped['state']}: {stopped.get('reason', '')}", stopped["triangles"] == first["triangles"])


def flight(options, url):
    chance = random.Random(options.seed)
    frames = []
    time_now = 0.0
    while time_now < options.seconds + 3:
        azimuth, elevation = chance.uniform(-180, 180), chance.uniform(-60, 80)
        distance = chance.choice((1.2, 1.6, 2.5, 4))
        frames.append({"time": round(time_now, 2),
                       "camera": f"azimuth={azimuth:.1f};elevation={elevation:.1f};distance={distance}"})
        time_now += chance.uniform(0.5, 3)
    path, log = options.folder / "flight.json", options.folder / "flight.csv"
    path.write_text(json.dumps({"frames_per_second": 5, "key_frames": frames}))
    summary = viewer(options, url, "--size", "640x480", "--path", path, "--path-log", log, "--triangle-budget",
                     options.triangles, "--memory-budget", options.memory, "--timeout", options.seconds)
    table = rows(log)
    triangles = max(int(row["triangles"]) for row in table)
    memory = max(int(row["memory"]) for row in table)
    tell(f"random flight, {float(table[-1]['time']):.0f} s",
         f"peak {triangles:,} of {options.triangles:,} triangles, {memory:,} of {options.memory:,} bytes; "
         f"{int(table[-1]['collapses']):,} collapses, {int(table[-1]['resplits']):,} splits from what was kept, "
         f"{int(table[-1]['splits']):,} records received, {summary['bytes_down']:,} bytes",
         triangles <= options.triangles and memory <= options.memory)


def window(options, url, script, *arguments):
    """Plays a script in a window under xvfb."""
    file = options.folder / "script.txt"
    file.write_text(script)
    return subprocess.run([*XVFB, str(options.bin / "meshfront-view"), str(url), "--script", str(file),
                           *map(str, arguments)], capture_output=True, text=True, cwd=options.folder)


def frames(options, url):
    orbit = "\n".join("key right\nwait-frames 2" for _ in range(25))
    done = window(options, url, f"""
wait-until state != connecting 60
wait 3
status arriving.json
wait-state complete 580
status complete.json
key right
wait 6
{orbit}
status resting.json
screenshot frames.png
""", "--complete", "--no-foveation")
    if done.returncode != 0:
        tell("frame times", done.stderr.strip(), False)
        return
    arriving = json.loads((options.folder / "arriving.json").read_text())
    complete = json.loads((options.folder / "complete.json").read_text())
    resting = json.loads((options.folder / "resting.json").read_text())
    quotient = complete["frame_95"] / resting["frame_median"]
    tell("frame times", f"{1000 * arriving['frame_median']:.0f} ms ({1000 * arriving['frame_95']:.0f} in 95 %) with "
         f"{arriving['triangles_shown']:,} triangles, {1000 * complete['frame_median']:.0f} "
         f"({1000 * complete['frame_95']:.0f}) in the last seconds of the arrival of {complete['records']:,} records; "
         f"at rest {1000 * resting['frame_median']:.0f} ({1000 * resting['frame_95']:.0f}); 95 % arriving / median at "
         f"rest {quotient:.2f}")


def lost(options, url, server):
    said = []
    ended = threading.Event()

    def interrupt():
        time.sleep(3.0)
        server.process.send_signal(signal.SIGSTOP)
        said.append("stopped")
        ended.wait(20)
        server.process.send_signal(signal.SIGCONT)
        said.append("continued")

    thread = threading.Thread(target=interrupt)
    thread.start()
    looks = "\n".join(f"status lost-{i:02d}.json\nwait 1" for i in range(26))
    done = window(options, url, f"{looks}\nscreenshot lost.png\nwait-state settled 90\nstatus settled.json\n"
                  "screenshot back.png\n", "--batch", "200")
    thread.join()
    states = []
    for i in range(26):
        with contextlib.suppress(OSError):
            status = json.loads((options.folder / f"lost-{i:02d}.json").read_text())
            text = status["state"] + (f" ({status['reason']})" if status["reason"] else "")
            if not states or states[-1][1] != text:
                states.append((i, text))
    tell("server silent for 20 s", "; ".join(f"{i} s: {text}" for i, text in states) +
         (": settled again" if done.returncode == 0 else f": {done.stderr.strip()}"), done.returncode == 0)


def scene(options, url):
    file = options.folder / "scene.json"
    size = options.size
    file.write_text(json.dumps({"meshes": [
        {"url": url, "name": "as it is"},
        {"url": url, "name": "turned", "translate": [1.2 * size, 0, 0],
         "rotate": {"axis": [0, 1, 0], "degrees": 180}},
        {"url": url, "name": "small", "translate": [-0.8 * size, 0, 0], "scale": 0.25}]}))
    summary = viewer(options, file, "--screenshot", options.folder / "scene.png")
    parts = ", ".join(f"{mesh['name']} {mesh['splits']:,}" for mesh in summary["meshes"])
    tell("scene of three", f"{summary['state']} with {summary['triangles']:,} triangles; splits: {parts}",
         summary["state"] == "settled")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("mesh", type=pathlib.Path)
    parser.add_argument("--parts", nargs="+", default=["loop", "restart", "flight", "frames", "lost", "scene"])
    parser.add_argument("--seconds", type=float, default=180)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        options.folder = options.keep or pathlib.Path(temporary)
        options.folder.mkdir(parents=True, exist_ok=True)
        packs = options.folder / "packs"
        packs.mkdir(exist_ok=True)
        done = run(options.bin / "meshfront-encode", options.mesh, "--output", packs / "mesh.pack")
        if done.returncode != 0:
            sys.exit(done.stderr)
        with Server(options.bin / "meshfront-serve", "--packs", packs, "--listen", "127.0.0.1:0") as server:
            url = f"{server.url}/v1/meshes/mesh"
            about = json.load(urllib.request.urlopen(url))
            low, high = about["bounds"]["min"], about["bounds"]["max"]
            options.size = max(b - a for a, b in zip(low, high))
            options.triangles = about["triangleCount"] // 4
            options.memory = 24_000_000 + 40 * about["triangleCount"]
            for part in options.parts:
                needs_server = part in ("restart", "lost")
                globals()[part](options, url, *([server] if needs_server else []))
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
