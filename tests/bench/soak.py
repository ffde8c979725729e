#!/usr/bin/env python3
"""Minutes of random valid, invalid and hostile requests to a service and a proxy in front of it.

  soak.py BIN_FOLDER [--mesh MESH...] [--minutes 10] [--seed 1] [--json]

Valid answers must be right to the octet, held against a second decoder's reading of the mesh that
was taken while the service was quiet; invalid requests get their 4xx as problem+json; what hostile
clients do costs nobody else an answer. Memory stays flat after the warm-up, threads and descriptors
are as many at the end as at the start, nothing crashes or restarts, /readyz is fine at the end, and
SIGTERM ends both programs with 0. A line every 10 s on a terminal, a report at the end. Every
worker draws from its own generator, so that a seed repeats what each one does. Exit status 1 if
anything is wrong.
"""
import argparse
import collections
import json
import pathlib
import random
import resource
import statistics
import subprocess
import sys
import tempfile
import time

from process_watch import descriptors, memory, threads
from other_tests import TESTS
from soak_reference import Mesh
from soak_requests import Ask, Wrong, valid
from soak_workers import Asker, Counts, Workers

from running_programs import Program, ask as ask_once, counters

SETTLING = 30  # seconds for connections and threads of the last requests to go


class Watch:
    """Memory, threads and descriptors of both programs over time."""

    def __init__(self, programs):
        self.programs = programs
        self.memory = {name: [] for name in programs}

    def ended(self):
        """Programs that run no more."""
        statuses = {name: program.process.poll() for name, program in self.programs.items()}
        return [f"{name} ended with status {status}" for name, status in statuses.items() if status is not None]

    def sample(self):
        for name, program in self.programs.items():
            self.memory[name].append(memory(program.process.pid))

    def held(self):
        """Threads; descriptors, those of clients' connections apart."""
        found = {}
        for name, program in self.programs.items():
            clients = counters(program.port)["meshfront_connections_open"] - 1
            sockets, others = descriptors(program.process.pid)
            found[name] = {"threads": threads(program.process.pid), "sockets": sockets - clients, "files": others}
        return found

    def settled(self, expected):
        """What is held at the end, and what of it is more or less than at the start."""
        deadline = time.monotonic() + SETTLING
        while True:
            now = self.held()
            # Each thread that waits for the upstream may keep a connection to it.
            pool = {"service": 0, "proxy": expected["proxy"]["threads"]}
            wrong = [f"{name} holds {now[name][what]} {what} instead of {count}"
                     for name, held in expected.items() for what, count in held.items()
                     if abs(now[name][what] - count) > (pool[name] + 1 if what == "sockets" else 0)]
            if not wrong or time.monotonic() > deadline:
                return now, wrong
            time.sleep(0.5)

    def growth(self, name):
        """(after the warm-up, in the middle, at the end), medians over some samples, in octets."""
        series = self.memory[name]
        width = max(1, len(series) // 10)
        parts = (series[width:2 * width], series[len(series) // 2:len(series) // 2 + width], series[-width:])
        return [int(statistics.median(part or series)) for part in parts]


def warm_up(counts, meshes, ports, seed):
    asker, chance = Asker(counts, ports, random.Random(f"{seed} warm-up")), random.Random(f"{seed} warm-up")
    for mesh in meshes:
        for port in ports:
            for target, body in mesh.bodies.items():
                asker.ask(port, Ask("resource", "GET", target, 200, body))
            for _ in range(50):
                asker.ask(port, valid(mesh, chance))
    asker.close()


def soak(options, programs, counts, meshes):
    ports = [program.port for program in programs.values()]
    warm_up(counts, meshes, ports, options.seed)
    watch = Watch(programs)
    before = watch.held()
    begin = shown = time.monotonic()
    end = begin + 60 * options.minutes
    with Workers(counts, meshes, ports, options.seed, options.idle):
        while time.monotonic() < end:
            time.sleep(max(0.05, min(0.25, options.minutes / 10)))
            if watch.ended():
                break
            watch.sample()
            if time.monotonic() - shown < 10:
                continue
            shown = time.monotonic()
            if sys.stdout.isatty() or options.verbose:
                megabytes = " + ".join(f"{series[-1] / 2**20:.0f}" for series in watch.memory.values())
                print(f"{shown - begin:6.0f} s  {counts.requests.total()} requests, {counts.hostile.total()} attacks, "
                      f"{counts.wrong} wrong; {megabytes} MiB", flush=True)
    report = {"seconds": time.monotonic() - begin, "memory": {}, "held_before": before, "held_after": before}
    if ended := watch.ended():
        counts.faults = ended + counts.faults
        counts.wrong += len(ended)
        return report
    report["held_after"], held = watch.settled(before)
    for text in held:
        counts.fault(text)
    for name, program in programs.items():
        if ask_once(program.port, "/readyz").status != 200:
            counts.fault(f"{name} is not ready at the end")
        early, middle, late = watch.growth(name)
        report["memory"][name] = {"early": early, "middle": middle, "end": late, "most": max(watch.memory[name])}
        if late - early > options.memory_slack * 2**20:
            counts.fault(f"{name} grew from {early >> 20} to {late >> 20} MiB after the warm-up")
    return report


def show(report):
    print(f"\n{report['seconds']:.0f} s, seed {report['seed']}\n\nrequests with right answers:")
    for kind, count in sorted(report["requests"].items()):
        print(f"  {count:8}  {kind}")
    print("hostile (answered with):")
    for kind, statuses in sorted(report["hostile"].items()):
        print(f"  {sum(statuses.values()):8}  {kind} ({', '.join(f'{k}: {v}' for k, v in sorted(statuses.items()))})")
    for name, held in report["memory"].items():
        mib = {key: f"{value / 2**20:.1f}" for key, value in held.items()}
        changes = "; ".join(f"{what} {count} -> {report['held_after'][name][what]}"
                            for what, count in report["held_before"][name].items())
        print(f"{name}: {mib['early']} MiB after the warm-up, {mib['middle']} in the middle, {mib['end']} at the "
              f"end (at most {mib['most']}); {changes}")
    print(f"wrong: {report['wrong']}")
    for text in report["faults"]:
        print(f"  {text}")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("programs", type=pathlib.Path, metavar="BIN_FOLDER")
    arguments.add_argument("--mesh", nargs="+", type=pathlib.Path, default=[TESTS / "data" / "bunny.ply.xz"])
    arguments.add_argument("--minutes", type=float, default=10)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--idle", type=int, default=2000, help="idle connections opened and dropped at a time")
    arguments.add_argument("--memory-slack", type=float, default=16, help="MiB of growth that count as flat")
    arguments.add_argument("--verbose", action="store_true", help="a line every 10 s wherever stdout goes")
    arguments.add_argument("--json", action="store_true")
    options = arguments.parse_args()
    files = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (files, files))
    counts = Counts()
    with tempfile.TemporaryDirectory() as folder:
        for mesh in options.mesh:
            pack = pathlib.Path(folder) / f"{mesh.name.split('.')[0]}.pack"
            encode = [options.programs / "meshfront-encode", mesh, "--output", pack]
            subprocess.run(encode, check=True, capture_output=True)
        service = Program(options.programs / "meshfront-serve", "--packs", folder, "--listen", "127.0.0.1:0")
        proxy = Program(options.programs / "meshfront-proxy", "--upstream", f"http://127.0.0.1:{service.port}",
                        "--listen", "127.0.0.1:0")
        programs = {"service": service, "proxy": proxy}
        try:
            names = [mesh.name.split(".")[0] for mesh in options.mesh]
            report = soak(options, programs, counts, [Mesh(service.port, name) for name in names])
        finally:
            statuses = {name: program.stop() for name, program in reversed(programs.items())}
        for name, status in statuses.items():
            if status != 0:
                counts.fault(f"{name} ends with status {status}")
    attacks = collections.defaultdict(dict)
    for (kind, status), count in counts.hostile.items():
        attacks[kind][str(status)] = count
    report |= {"seed": options.seed, "requests": counts.requests, "hostile": attacks, "reconnected": counts.reconnected,
               "wrong": counts.wrong, "faults": counts.faults}
    print(json.dumps(report)) if options.json else show(report)
    return 1 if counts.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
