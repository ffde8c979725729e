#!/usr/bin/env python3
"""Prints what the receiver's two ways to fetch cost: exact sets of nodes, or whole chunks.

  fetch_modes.py BIN_FOLDER MESH... [--views whole half close] [--receivers 1 10 100 1000]

For each mesh: encodes it, serves it, and then
  - for each view, streams it either way until it has settled, at 500x500 against the input, and
    tells bytes and requests to a PSNR of 35 dB and to the end;
  - puts nginx with an empty cache in front and lets receivers look from different views, one view
    each: which share of the requests for records, and of their bytes, nginx answered itself. The
    proxy in the place of nginx, exact sets only, for comparison.
Needs nginx. Tables in Markdown on stdout, each row also on stderr when it is there: a thousand
receivers of the bunny take some minutes, larger meshes in proportion. Exit status 1 if a receiver
did not settle.
"""

import argparse
import json
import pathlib
import signal
import sys
import tempfile

from nginx_process import NginxProcess
from random_views import write_views
from served_programs import Server, run

# What matters of a cache in front: answers are kept for as long as they say, and simultaneous
# misses of one URL become one request.
NGINX = """
  proxy_cache_path FOLDER/cache keys_zone=records:64m max_size=4g inactive=1d use_temp_path=off;
  log_format kinds '$request_method $upstream_cache_status $body_bytes_sent $request_uri';
  access_log FOLDER/access.log kinds;
  keepalive_requests 1000000;
  upstream origin { server ORIGIN; keepalive 16; }
  server {
    listen 127.0.0.1:PORT backlog=4096;
    large_client_header_buffers 4 16k;
    location / {
      proxy_pass http://origin;
      proxy_http_version 1.1;
      proxy_set_header Connection "";
      proxy_cache records;
      proxy_cache_lock on;
    }
  }
"""


class Nginx(NginxProcess):
    """In front of an origin, with an empty cache; its log tells what it answered itself."""

    def __init__(self, origin):
        self.files = tempfile.TemporaryDirectory()
        http = NGINX.replace("ORIGIN", origin.removeprefix("http://"))
        super().__init__(pathlib.Path(self.files.name), http)

    def __exit__(self, *error):
        super().__exit__(*error)
        self.files.cleanup()

    def record_requests(self):
        """[(was a hit, bytes)] of the requests for records and chunks."""
        self.process.send_signal(signal.SIGUSR1)  # nginx reopens its log, all that was written is there
        lines = (self.folder / "access.log").read_text().splitlines()
        found = []
        for line in lines:
            _, state, length, target = line.split()
            if "/splits" in target or "/chunks/" in target:
                found.append((state == "HIT", int(length)))
        return found


def table(title, header, rows):
    print(f"\n{title}\n\n| " + " | ".join(header) + " |")
    print("|---" * len(header) + "|")
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    sys.stdout.flush()


def costs(programs, url, mesh, view, fetch):
    """One view's bytes and requests: to 35 dB, then settled."""
    done = run(
        programs / "meshfront-view", url, "--headless", "--size", "500x500", "--json", "--camera", view,
        "--fetch", fetch, "--reference", mesh, "--psnr-target", "35",
    )
    if done.returncode != 0:
        sys.exit(f"meshfront-view {url}: {done.stderr}")
    report = json.loads(done.stdout)
    target = report["psnr_target"]
    row = [mesh.stem, view, fetch]
    row += [target[k] for k in ("bytes_down", "bytes_up", "requests")] if target["reached"] else ["-"] * 3
    row += [report[k] for k in ("bytes_down", "bytes_up", "requests")]
    return row + [f"{report['psnr']:.1f}", f"{100 * report['share']:.0f} %"]


def load(programs, url, views, receivers, fetch, *options):
    done = run(
        programs / "meshfront-load", "--url", url, "--views", f"each:{views}", "--receivers", receivers,
        "--concurrency", 64, "--fetch", fetch, "--json", *options,
    )
    if not done.stdout:
        sys.exit(f"meshfront-load {url}: {done.stderr}")
    return json.loads(done.stdout)


def tell(row):
    print(" | ".join(str(cell) for cell in row), file=sys.stderr, flush=True)
    return row


def percent(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def hit_ratios(programs, service, name, views, receivers, fetch):
    with Nginx(service.url) as nginx:
        report = load(programs, f"{nginx.url}/v1/meshes/{name}", views, receivers, fetch)
        requests = nginx.record_requests()
    hits = [length for hit, length in requests if hit]
    total = sum(length for _, length in requests)
    row = [name, receivers, fetch, "nginx", len(requests), percent(len(hits), len(requests))]
    row += [percent(sum(hits), total), total // receivers, total - sum(hits)]
    return row, report["settled"] == receivers


def proxy_ratios(programs, service, name, views, receivers):
    with Server(
        programs / "meshfront-proxy", "--upstream", service.url, "--listen", "127.0.0.1:0"
    ) as proxy:
        report = load(
            programs, f"{proxy.url}/v1/meshes/{name}", views, receivers, "exact",
            "--origin-metrics", service.url,
        )
    total, served = report["record_bytes"], int(report["origin"]["record_bytes"])
    row = [name, receivers, "exact", "proxy", "", "", percent(total - served, total), total // receivers, served]
    return row, report["settled"] == receivers


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("programs", type=pathlib.Path, metavar="BIN_FOLDER")
    arguments.add_argument("meshes", nargs="+", type=pathlib.Path, metavar="MESH")
    arguments.add_argument("--views", nargs="*", default=["whole", "half", "close"])
    arguments.add_argument("--receivers", nargs="*", type=int, default=[1, 10, 100, 1000])
    options = arguments.parse_args()
    programs = options.programs
    pictures, ratios, settled = [], [], True
    with tempfile.TemporaryDirectory() as folder:
        packs = pathlib.Path(folder)
        for mesh in options.meshes:
            encoded = run(programs / "meshfront-encode", mesh, "--output", packs / f"{mesh.stem}.pack")
            if encoded.returncode != 0:
                sys.exit(encoded.stderr)
        with Server(programs / "meshfront-serve", "--packs", packs, "--listen", "127.0.0.1:0") as service:
            for mesh in options.meshes:
                url = f"{service.url}/v1/meshes/{mesh.stem}"
                for view in options.views:
                    for fetch in ("exact", "chunks"):
                        pictures.append(tell(costs(programs, url, mesh, view, fetch)))
                for receivers in options.receivers:
                    views = packs / "views.txt"
                    write_views(views, receivers)
                    of_mesh = (programs, service, mesh.stem, views, receivers)
                    for ratio in (
                        lambda: hit_ratios(*of_mesh, "exact"),
                        lambda: hit_ratios(*of_mesh, "chunks"),
                        lambda: proxy_ratios(*of_mesh),
                    ):
                        row, good = ratio()
                        ratios.append(tell(row))
                        settled &= good
    if pictures:
        table(
            "Bytes of HTTP down and up and requests for records: to 35 dB, then until the view has settled (500x500)",
            ["mesh", "view", "fetch", "down", "up", "requests", "settled: down", "up", "requests", "dB", "of all records"],
            pictures,
        )
    if ratios:
        table(
            "Receivers on different views behind an empty cache: what of the records the cache answered itself",
            ["mesh", "receivers", "fetch", "cache", "requests", "hits", "bytes hit", "bytes a receiver", "bytes of the service"],
            ratios,
        )
    return 0 if settled else 1


if __name__ == "__main__":
    sys.exit(main())
