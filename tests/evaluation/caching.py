#!/usr/bin/env python3
"""Experiment 8: what the origin sends when more and more receivers look at a mesh.

  caching.py --output DIR [--bin build/bin] [--short] MESH...

The receivers are those of meshfront-load; each looks from one of 100 views, drawn by Zipf's law, and
streams it until it has settled. Between them and meshfront-serve stands nothing, nginx, meshfront-proxy,
or nginx before meshfront-proxy, each empty at first; receivers come one after the other, 16 alive at
a time, and the origin's own counters are read when there have been 1, 3, 10, 30 ... of them. Either
exact sets are fetched or chunks. Writes DIR/caching: caching.csv, figures.json and plots.json.
"""

import contextlib
import json
import pathlib
import re
import sys
import tempfile
import time
import urllib.request

import beside_bench  # noqa: F401  (finds tests/bench)
from encoded_meshes import encode, mesh_name
from experiment_command import experiment_parser
from experiment_files import ExperimentFiles
from fetch_modes import Nginx
from random_views import write_views
from served_programs import Server, run

VIEWS = 100
ALIVE = 16
COUNTS = {"bunny": (1, 3, 10, 30, 100, 300)}
OTHER_COUNTS = (1, 3, 10, 30, 100)
SHORT_COUNTS = (1, 10)
CACHES = ("no cache", "nginx", "proxy", "nginx and proxy")
FETCHES = {"exact": "exact sets", "chunks": "chunks"}
NOTE = ("Octets of records that meshfront-serve sent, by its own counters; base mesh, metadata and headers are not "
        "among them. Nothing published stands beside it: the publications have no caches.")


def origin_counters(service):
    """(octets of records, requests for anything but metrics and health) since the service began."""
    page = urllib.request.urlopen(f"{service.url}/metrics", timeout=30).read().decode()
    octets = sum(float(value) for value in re.findall(r"^meshfront_(?:record|chunk)_bytes_total (\S+)$", page, re.MULTILINE))
    requests = re.findall(r'^meshfront_requests_total\{route="(\w+)",[^}]*\} (\S+)$', page, re.MULTILINE)
    return int(octets), int(sum(float(value) for route, value in requests if route not in ("metrics", "health", "ready")))


@contextlib.contextmanager
def standing_between(programs, service, cache):
    """The address that receivers use."""
    with contextlib.ExitStack() as stack:
        url = service.url
        if "proxy" in cache:
            url = stack.enter_context(Server(programs / "meshfront-proxy", "--upstream", url, "--listen", "127.0.0.1:0")).url
        if "nginx" in cache:
            url = stack.enter_context(Nginx(url)).url
        yield url


def receive(programs, url, views, fetch, receivers, seed):
    done = run(programs / "meshfront-load", "--url", url, "--views", f"zipf:{views}", "--receivers", receivers, "--concurrency",
               ALIVE, "--fetch", fetch, "--seed", seed, "--json")
    report = json.loads(done.stdout) if done.stdout else {}
    if report.get("settled") != receivers:
        sys.exit(f"meshfront-load {url}: {report.get('settled', 'none')} of {receivers} settled. {done.stdout.strip()} {done.stderr.strip()}")
    return report


def measure(programs, service, mesh, views, fetch, cache, counts, files):
    begin, received, so_far = origin_counters(service), 0, 0
    started = time.monotonic()
    with standing_between(programs, service, cache) as url:
        for count in counts:
            report = receive(programs, f"{url}/v1/meshes/{mesh}", views, fetch, count - so_far, seed=count)
            received, so_far = received + report["record_bytes"], count
            now = origin_counters(service)
            files.add("caching.csv", {"mesh": mesh, "fetch": fetch, "cache": cache, "receivers": count,
                                      "origin_bytes": now[0] - begin[0], "origin_requests": now[1] - begin[1],
                                      "received_bytes": received})
    print(f"{mesh}, {fetch}, {cache}: {time.monotonic() - started:.1f} s", flush=True)


def tell(files, mesh):
    for fetch, way in FETCHES.items():
        for row in files.rows("caching.csv"):
            if (row["mesh"], row["fetch"]) != (mesh, fetch):
                continue
            count = row["receivers"]
            where = {"row": f"{count} receiver{'s' if count > 1 else ''}", "column": row["cache"], "csv": "caching.csv"}
            files.figure(8, table=f"Octets of records from the origin: {mesh}, {way}", **where,
                         value=round(row["origin_bytes"] / 1000, 1), unit="kB", note=NOTE)
            files.figure(8, table=f"Requests at the origin: {mesh}, {way}", **where, value=row["origin_requests"], unit="")
    for what, label in (("origin_bytes", "octets of records from the origin"), ("origin_requests", "requests at the origin")):
        files.plot(f"{what}_{mesh}", f"{mesh}: {label}", "receivers", label, [
            {"label": f"{FETCHES[fetch]}, {cache}", "csv": "caching.csv", "where": {"mesh": mesh, "fetch": fetch, "cache": cache},
             "x_column": "receivers", "y_column": what} for fetch in FETCHES for cache in CACHES],
            caption=f"{label.capitalize()} by the number of receivers that have come, {VIEWS} views by Zipf's law.",
            log_x=True, log_y=True)


def main():
    options = experiment_parser(__doc__, "caching").parse_args()
    files = ExperimentFiles(options.output / "caching")
    with tempfile.TemporaryDirectory() as folder:
        packs = pathlib.Path(folder)
        names = []
        for path in options.meshes:
            names.append(mesh_name(path))
            encode(options.bin, path, packs / f"{names[-1]}.pack")
        write_views(packs / "views.txt", VIEWS)
        with Server(options.bin / "meshfront-serve", "--packs", packs, "--listen", "127.0.0.1:0") as service:
            for name in names:
                counts = SHORT_COUNTS if options.short else COUNTS.get(name, OTHER_COUNTS)
                for fetch in FETCHES:
                    for cache in CACHES:
                        measure(options.bin, service, name, packs / "views.txt", fetch, cache, counts, files)
                tell(files, name)
    files.write()
    return 0


if __name__ == "__main__":
    sys.exit(main())
