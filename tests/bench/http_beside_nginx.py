#!/usr/bin/env python3
"""Prints requests/s over HTTP on one core: nginx with static files, the service, the proxy.

  http_beside_nginx.py BIN_FOLDER [--sizes 4096 16384 65536] [--answers chunk records]
                       [--rounds 7] [--seconds 3] [--connections 64] [--json]

For each size a synthetic pack whose chunks have about that many octets, and two answers of it:
  chunk    one chunk as it lies in the pack (.../chunks/N);
  records  a set of nodes, whose records are looked up and copied one by one (.../splits/IDS).
nginx serves both as files of exactly these octets: one worker, sendfile, tcp_nopush, files kept
open, no log. The service and the proxy, which has everything cached, run with one thread. wrk asks
with one thread over connections that are kept. Each server runs on the first core, wrk on the
second; they take turns within a round, and what is printed are medians of all rounds: requests/s,
service/nginx and proxy/service; then microseconds of processor that a request took the server,
which other work on the machine disturbs less. Needs nginx and wrk. Exit status 1 if an answer was
wrong.
"""

import argparse
import contextlib
import json
import os
import pathlib
import re
import statistics
import sys
import tempfile
import urllib.request

from nginx_process import NginxProcess
from served_programs import Server, run

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "integration"))
from node_sets import ids  # noqa: E402

SERVER_CORE, CLIENT_CORE = "0", "1"
RECORD_BITS = 41  # of a synthetic record on average, for a first guess

NGINX = """
  sendfile on;
  tcp_nopush on;
  tcp_nodelay on;
  keepalive_timeout 75;
  keepalive_requests 1000000000;
  open_file_cache max=1000 inactive=1h;
  open_file_cache_valid 1h;
  access_log off;
  default_type application/octet-stream;
  server {
    listen 127.0.0.1:PORT backlog=4096;
    root FOLDER/files;
    location / { add_header Cache-Control "public, max-age=31536000, immutable"; }
  }
"""


def get(url):
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with opener.open(url, timeout=60) as response:
        return response.read()


class Nginx(NginxProcess):
    """Serves what is added as files."""

    def __init__(self, folder):
        (folder / "files").mkdir()
        super().__init__(folder, NGINX, ("taskset", "-c", SERVER_CORE))

    def worker(self):
        pid = self.process.pid
        return int(pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()[0])

    def add(self, name, content):
        (self.folder / "files" / name).write_bytes(content)
        return f"/{name}"


def write_pack(programs, packs, size):
    """One whose chunks have about `size` octets, and with records for sets of that size."""
    records = size * 8 // RECORD_BITS
    done = run(
        programs / "write-synthetic-pack", packs / f"{size}.pack", f"chunks-{size}", "1", "4000", "9", records
    )
    if done.returncode != 0:
        sys.exit(done.stderr)
    return done.stdout.split()[1].rstrip(":")


def chunk_near(service, fixed, size):
    """The target of the chunk, of the first 40, that is nearest to the size."""
    count = json.loads(get(f"{service}{fixed.rsplit('/', 1)[0]}"))["chunkCount"]
    chunks = [f"{fixed}/chunks/{n}" for n in range(min(count, 40))]
    return min(chunks, key=lambda target: abs(len(get(service + target)) - size))


def records_near(service, fixed, size):
    """The target of a set of trees, each to a depth of six, whose answer is nearest to the size."""

    def target(trees):
        return f"{fixed}/splits/{ids([(5 + tree, '') for tree in range(trees)])}?levels=6"

    fewest, most = 1, 2000
    while fewest < most:
        middle = (fewest + most) // 2
        if len(get(service + target(middle))) < size:
            fewest = middle + 1
        else:
            most = middle
    return target(fewest)


ANSWERS = {"chunk": chunk_near, "records": records_near}


def processor_seconds(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def ask_many(url, pid, connections, seconds):
    """Requests/s, and microseconds of processor that one took the server."""
    used = processor_seconds(pid)
    done = run("taskset", "-c", CLIENT_CORE, "wrk", "-t1", f"-c{connections}", f"-d{seconds}s", url)
    used = processor_seconds(pid) - used
    rate = re.search(r"Requests/sec:\s+([\d.]+)", done.stdout)
    count = re.search(r"(\d+) requests in", done.stdout)
    if not rate or not count or "Non-2xx" in done.stdout or "Socket errors" in done.stdout:
        sys.exit(f"wrk {url}: {done.stdout}{done.stderr}")
    return float(rate.group(1)), used * 1e6 / max(int(count.group(1)), 1)


def measure(cases, pids, options):
    """cases: [{urls: {server: url}}]. Adds medians for each server; servers take turns."""
    rates = [{server: [] for server in case["urls"]} for case in cases]
    costs = [{server: [] for server in case["urls"]} for case in cases]
    for number in range(options.rounds):
        for case, found, cost in zip(cases, rates, costs):
            for server, url in case["urls"].items():
                rate, used = ask_many(url, pids[server], options.connections, options.seconds)
                found[server].append(rate)
                cost[server].append(used)
        if sys.stderr.isatty():
            print(f"\rround {number + 1} of {options.rounds}", end="", file=sys.stderr)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    for case, found, cost in zip(cases, rates, costs):
        case["microseconds"] = {server: statistics.median(values) for server, values in cost.items()}
        case["rates"] = {server: statistics.median(values) for server, values in found.items()}
        # Of each round, since what else the machine does differs from round to round.
        for over, under in (("service", "nginx"), ("proxy", "service")):
            quotients = [a / b for a, b in zip(found[over], found[under])]
            case[f"{over}/{under}"] = statistics.median(quotients)


def prepare(service, proxy, nginx, revisions, answers):
    """A case for each size and kind of answer; the proxy has all of them cached then."""
    cases = []
    for size, revision in revisions.items():
        fixed = f"/v1/meshes/chunks-{size}/{revision}"
        for kind in answers:
            target = ANSWERS[kind](service.url, fixed, size)
            content = get(service.url + target)
            urls = {
                "nginx": nginx.url + nginx.add(f"{kind}-{size}", content),
                "service": service.url + target,
                "proxy": proxy.url + target,
            }
            if any(get(url) != content for url in urls.values() for _ in range(2)):
                sys.exit(f"{target} is not answered alike")
            cases.append({"size": size, "answer": kind, "octets": len(content), "urls": urls})
    return cases


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path, metavar="BIN_FOLDER")
    parser.add_argument("--sizes", type=int, nargs="+", default=[4096, 16384, 65536], help="octets")
    parser.add_argument("--answers", nargs="+", choices=ANSWERS, default=list(ANSWERS))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--seconds", type=int, default=3, help="of each run of wrk")
    parser.add_argument("--connections", type=int, default=64)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    with contextlib.ExitStack() as stack:
        folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
        packs = folder / "packs"
        packs.mkdir()
        revisions = {size: write_pack(options.programs, packs, size) for size in options.sizes}
        pinned = ("taskset", "-c", SERVER_CORE)
        listen = ("--listen", "127.0.0.1:0", "--threads", "1")
        service = stack.enter_context(
            Server(*pinned, options.programs / "meshfront-serve", "--packs", packs, *listen)
        )
        proxy = stack.enter_context(
            Server(*pinned, options.programs / "meshfront-proxy", "--upstream", service.url, *listen)
        )
        nginx = stack.enter_context(Nginx(folder))
        cases = prepare(service, proxy, nginx, revisions, options.answers)
        pids = {"service": service.process.pid, "proxy": proxy.process.pid, "nginx": nginx.worker()}
        measure(cases, pids, options)
    if options.json:
        print(json.dumps([{key: value for key, value in case.items() if key != "urls"} for case in cases]))
        return
    print("| answer | octets | nginx, requests/s | service | proxy | service/nginx | proxy/service "
          "| nginx, us/request | service | proxy |")
    print("|---" * 10 + "|")
    for case in cases:
        servers = ("nginx", "service", "proxy")
        rates = " | ".join(f"{case['rates'][server]:.0f}" for server in servers)
        costs = " | ".join(f"{case['microseconds'][server]:.1f}" for server in servers)
        print(
            f"| {case['answer']} | {case['octets']} | {rates} | "
            f"{case['service/nginx']:.2f} | {case['proxy/service']:.2f} | {costs} |"
        )


if __name__ == "__main__":
    main()
