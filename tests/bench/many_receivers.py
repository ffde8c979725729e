#!/usr/bin/env python3
"""Ten thousand receivers through one proxy on this machine: does every one settle?

  many_receivers.py BIN_FOLDER [MESH] [--receivers 10000] [--views 100] [--concurrency 256]

Encodes the mesh (default: the bunny), starts a service, a proxy with an empty cache in front of it
and meshfront-load, whose receivers look from random views drawn by Zipf's law, some of them alive
at a time. A line a second on stderr; at the end the report. Exit status 1 if a receiver did not
settle, anything failed, or the service sent 2 % of the record bytes or more.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from other_tests import TESTS
from random_views import write_views
from served_programs import Server, run

MOST_SHARE = 0.02  # of the record bytes from the service


def cpu_seconds(process):
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def percentiles(seconds):
    return " / ".join(f"{seconds[key]:.3f}" for key in ("p50", "p90", "p99", "max")) + " s (50 / 90 / 99 % / longest)"


def show(report, cpu):
    receivers, seconds = report["started"], report["seconds"]
    print(f"receivers  {receivers} started, {report['settled']} settled, {report['failed']} failed, "
          f"{report['unfinished']} given up; at most {report['most_alive']} at a time")
    print(f"time       {seconds:.0f} s: {receivers / seconds:.1f} receivers and "
          f"{report['requests'] / seconds:.0f} requests a second")
    print(f"settling   {percentiles(report['settled_seconds'])}")
    print(f"latency    {percentiles(report['latency_seconds'])} of a request")
    print(f"errors     {report['errors'] or 'none'}; {report['repeated_attempts']} attempts repeated, "
          f"{report['malformed_answers']} damaged answers, resumed {report['resumed']} times")
    for reason, count in report["failures"].items():
        print(f"           {count}: {reason}")
    print(f"bytes      {report['bytes_down']:,} down ({report['record_bytes']:,} of records), "
          f"{report['bytes_up']:,} up")
    print(f"records    {report['records']:,}")
    print(f"origin     {report['origin']['record_bytes']:,.0f} bytes of records, {100 * report['origin']['share']:.3f} % "
          f"of what receivers got")
    print(f"CPU        {cpu['service']:.1f} s service, {cpu['proxy']:.1f} s proxy, {cpu['receivers']:.1f} s receivers "
          f"({1000 * cpu['receivers'] / receivers:.1f} ms each)")
    print(f"memory     {report['peak_memory_bytes'] / 2**20:.0f} MiB of all receivers at most")


def well(report, receivers):
    return (report["settled"] == receivers and not report["errors"] and not report["failed"]
            and not report["malformed_answers"] and report["origin"]["share"] < MOST_SHARE)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("programs", type=pathlib.Path, metavar="BIN_FOLDER")
    arguments.add_argument("mesh", nargs="?", type=pathlib.Path, metavar="MESH", default=TESTS / "data" / "bunny.ply.xz")
    arguments.add_argument("--receivers", type=int, default=10_000)
    arguments.add_argument("--views", type=int, default=100)
    arguments.add_argument("--concurrency", type=int, default=256, help="receivers alive at a time")
    arguments.add_argument("--fetch", choices=("exact", "chunks"), default="exact")
    arguments.add_argument("--json", action="store_true", help="print meshfront-load's own JSON")
    options = arguments.parse_args()
    programs = options.programs
    with tempfile.TemporaryDirectory() as folder:
        packs = pathlib.Path(folder)
        views = packs / "views.txt"
        write_views(views, options.views)
        encoded = run(programs / "meshfront-encode", options.mesh, "--output", packs / "mesh.pack", "--name", "mesh")
        if encoded.returncode != 0:
            sys.exit(encoded.stderr)
        with Server(programs / "meshfront-serve", "--packs", packs, "--listen", "127.0.0.1:0") as service, \
             Server(programs / "meshfront-proxy", "--upstream", service.url, "--listen", "127.0.0.1:0") as proxy:
            command = [programs / "meshfront-load", "--url", f"{proxy.url}/v1/meshes/mesh", "--views", f"zipf:{views}",
                       "--receivers", options.receivers, "--concurrency", options.concurrency, "--fetch", options.fetch,
                       "--origin-metrics", service.url, "--verbose", "--json"]
            before = os.times()
            done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, text=True)
            after = os.times()
            cpu = {"service": cpu_seconds(service.process), "proxy": cpu_seconds(proxy.process),
                   "receivers": after.children_user + after.children_system - before.children_user - before.children_system}
    if not done.stdout:
        return 1
    report = json.loads(done.stdout)
    print(done.stdout, end="") if options.json else show(report, cpu)
    return 0 if well(report, options.receivers) else 1


if __name__ == "__main__":
    sys.exit(main())
