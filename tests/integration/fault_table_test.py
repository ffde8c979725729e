#!/usr/bin/env python3
"""What receivers see of faults, with real programs: the fault table.

    fault_table_test.py BIN_FOLDER [ROW...]

All rows run side by side, each with its own ports, and the last lines printed are the table:
fault | what receivers saw | recovered in. Demanded is that every receiver ends with what it asked
for, that whoever takes the whole mesh has exactly what was encoded, and that proxies afterwards
answer every request that a fault touched, and those beside it, octet for octet as the service. The
times are for people; none fails the test.
"""
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import traceback

import real_caches
from hostile_relay import FAULTS, HostileRelay
from node_sets import ids
from running_programs import BINARY, Program, ask

AWAY_SECONDS = 20
COMPARED_FIELDS = ("content-type", "cache-control", "etag")


def write_mesh(path, bumps):
    """A torus of about 4,000 triangles."""
    around, across = 56, 36
    with open(path, "w", encoding="ascii") as file:
        for i in range(around):
            for j in range(across):
                a, b = 2 * math.pi * i / around, 2 * math.pi * j / across
                t = 0.4 + 0.04 * math.sin(bumps * a) * math.cos(4 * b)
                file.write(f"v {(1 + t * math.cos(b)) * math.cos(a):.6f} "
                           f"{(1 + t * math.cos(b)) * math.sin(a):.6f} {t * math.sin(b):.6f}\n")
        for i in range(around):
            for j in range(across):
                p, q = i * across + j + 1, (i + 1) % around * across + j + 1
                s, r = i * across + (j + 1) % across + 1, (i + 1) % around * across + (
                    j + 1) % across + 1
                file.write(f"f {p} {q} {r}\nf {p} {r} {s}\n")


class House:
    """The folder, the meshes, and what every row uses."""

    def __init__(self, bin_folder, folder):
        self.bin, self.folder = bin_folder, folder
        self.mesh = os.path.join(folder, "mesh.obj")
        for name, bumps in (("packs", 9), ("outdated", 7)):
            os.mkdir(os.path.join(folder, name))
            mesh = self.mesh if name == "packs" else os.path.join(folder, "outdated.obj")
            write_mesh(mesh, bumps)
            subprocess.run([self.program("meshfront-encode"), mesh, "--output",
                            os.path.join(folder, name, "mesh.pack"), "--name", "mesh"],
                           check=True, stdout=subprocess.DEVNULL)
        self.warm, self.cold = (self.write_views(name, azimuths) for name, azimuths in
                                (("warm", (0, 120, 240)), ("cold", (70, 200))))
        self.service = self.serve()
        self.outdated = self.serve(packs="outdated")

    def program(self, name):
        return os.path.join(self.bin, name)

    def write_views(self, name, azimuths):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="ascii") as file:
            file.writelines(f"{view};azimuth={azimuth}\n" for azimuth in azimuths
                            for view in ("whole", "half", "close"))
        return path

    def serve(self, port=0, packs="packs"):
        return Program(self.program("meshfront-serve"), "--packs",
                       os.path.join(self.folder, packs), "--listen", f"127.0.0.1:{port}")

    def proxy(self, upstream, *options, port=0):
        return Program(self.program("meshfront-proxy"), "--upstream",
                       f"http://127.0.0.1:{upstream}", "--listen", f"127.0.0.1:{port}", *options)

    def stop(self):
        return [self.service.stop(), self.outdated.stop()]


class Load:
    """Simulated receivers, each from its own view, that must all settle."""

    def __init__(self, house, port, receivers, views, *options):
        self.receivers = receivers
        self.process = subprocess.Popen(
            [house.program("meshfront-load"), "--url", f"http://127.0.0.1:{port}/v1/meshes/mesh",
             "--receivers", str(receivers), "--views", views, "--patience", "300", "--json",
             "--workers", "1", *options],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def end(self):
        out, err = self.process.communicate()
        assert self.process.returncode == 0, out + err
        report = json.loads(out)
        assert report["settled"] == report["started"] == self.receivers, out
        assert report["failed"] == report["unfinished"] == 0, out
        return report


def sum_up(reports):
    """What receivers saw, in words."""
    settled = sum(report["settled"] for report in reports)
    seen = {"repeated attempts": sum(r["repeated_attempts"] for r in reports),
            "damaged answers": sum(r["malformed_answers"] for r in reports),
            "times resumed": sum(r["resumed"] for r in reports)}
    for report in reports:
        for error, count in report["errors"].items():
            seen[error] = seen.get(error, 0) + count
    return ", ".join([f"{settled} settled"] +
                     [f"{count} {what}" for what, count in seen.items() if count])


class WholeMesh:
    """A receiver that takes everything, and has to end with exactly the mesh."""

    def __init__(self, house, port, name, *mode):
        self.house, self.output = house, os.path.join(house.folder, f"{name}.ply")
        self.process = subprocess.Popen(
            [house.program("fetch-mesh"), f"http://127.0.0.1:{port}/v1/meshes/mesh", self.output,
             *mode], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def end(self):
        out, err = self.process.communicate()
        assert self.process.returncode == 0, err
        subprocess.run([self.house.program("meshfront-pack"), "compare", self.house.mesh,
                        self.output], check=True, stdout=subprocess.DEVNULL)
        os.remove(self.output)
        resumed, damaged = out.split()
        return int(resumed), int(damaged)


class Prober:
    """Asks all the time for something that no cache has; notes when that was answered."""

    def __init__(self, port):
        self.port, self.answered, self.ending = port, [], False
        self.thread = threading.Thread(target=self.work)
        self.thread.start()

    def work(self):
        fixed = None
        number = 100000
        while not self.ending:
            try:
                if fixed is None:
                    fixed = fixed_part(self.port)
                number += 1
                if ask(self.port, f"{fixed}/chunks/{number}").status == 404:
                    self.answered.append(time.monotonic())
            except (OSError, ValueError, IndexError):
                pass
            time.sleep(0.1)

    def wait(self, since):
        """Seconds from `since` to the first answer."""
        while not any(when >= since for when in self.answered):
            time.sleep(0.02)
        return min(when for when in self.answered if when >= since) - since

    def end(self):
        self.ending = True
        self.thread.join()

    def longest_gap(self):
        return max(b - a for a, b in zip(self.answered, self.answered[1:]))


def fixed_part(port):
    link = json.loads(ask(port, "/v1/meshes/mesh").body)["links"]["base"]
    return link.removesuffix("/base")


def kill(program):
    program.process.kill()
    program.process.wait()
    program.process.stdout.close()


def some_requests(house):
    """Everything that has a URL, and some sets of nodes."""
    fixed = fixed_part(house.service.port)
    metadata = json.loads(ask(house.service.port, "/v1/meshes/mesh").body)
    roots = [tree for tree in range(metadata["baseVertexCount"])
             if ask(house.service.port, f"{fixed}/splits/{ids([(tree, '')])}").status == 200]
    sets = [ids([(tree, "") for tree in roots])] + [ids([(tree, "")]) for tree in roots[:8]]
    targets = ["/v1/meshes", "/v1/meshes/mesh", f"{fixed}/base", f"{fixed}/chunks"]
    targets += [f"{fixed}/chunks/{n}" for n in range(metadata["chunkCount"] + 2)]
    targets += [f"{fixed}/splits/{one}{more}" for one in sets
                for more in ("", "?levels=1", f"?significance={metadata['maxLevel']}")]
    return [("GET", target, None) for target in targets]


def expect_equal(house, port, requests):
    """The proxy answers as the service does."""
    for method, target, body in requests:
        headers = {"Content-Type": BINARY} if body else None
        right = ask(house.service.port, target, method, body, headers)
        give_up = time.monotonic() + 120
        while True:
            answer = ask(port, target, method, body, headers)
            if answer.status < 500 or time.monotonic() > give_up:
                break
            time.sleep(0.2)
        assert answer.status == right.status, (port, target)
        # Why there is nothing, each says in its own words.
        assert answer.body == right.body or right.status == 404, (port, target)
        for field in COMPARED_FIELDS:
            assert answer.headers.get(field) == right.headers.get(field), (target, field)


# --- the rows --------------------------------------------------------------------------------------


def replica_killed(house):
    """Behind HAProxy with the file of deploy/, with its proxies and past them."""
    replicas = [house.serve(), house.serve()]
    ports = [replica.port for replica in replicas]
    haproxy = real_caches.HAProxy(house.folder, house.bin, ports)
    probers = []
    try:
        probers.append(Prober(haproxy.replicas_port))
        loads = [Load(house, port, 60, f"zipf:{house.warm}", "--arrivals", "12", "--concurrency",
                      "8") for port in (haproxy.port, haproxy.replicas_port)]
        for which in (0, 1):
            time.sleep(1)
            kill(replicas[which])
            time.sleep(1)
            replicas[which] = house.serve(port=ports[which])
        reports = [load.end() for load in loads]
        probers[0].wait(time.monotonic())
        expect_equal(house, haproxy.port, some_requests(house))
    finally:
        for prober in probers:
            prober.end()
        haproxy.stop()
        for replica in replicas:
            replica.stop()
    return [("service killed, of two", sum_up(reports), probers[0].longest_gap())]


def proxy_killed(house):
    proxy = house.proxy(house.service.port)
    port = proxy.port
    prober = Prober(port)
    try:
        load = Load(house, port, 60, f"zipf:{house.warm}", "--arrivals", "12", "--concurrency", "8")
        whole = WholeMesh(house, port, "proxy-killed", "chunks")
        time.sleep(1.5)
        kill(proxy)
        time.sleep(1)
        since = time.monotonic()
        proxy = house.proxy(house.service.port, port=port)
        recovered = prober.wait(since)
        report = load.end()
        whole.end()
        expect_equal(house, port, some_requests(house))
    finally:
        prober.end()
        proxy.stop()
    return [("proxy killed, 1 s", sum_up([report]), recovered)]


def origin_away(house, how):
    """Those who look at what is cached see nothing of it; the others wait and then go on."""
    origin = house.serve()
    proxy = house.proxy(origin.port, "--timeout", "2")
    prober = Prober(proxy.port)
    try:
        Load(house, proxy.port, 9, f"each:{house.warm}").end()
        begin = time.monotonic()
        if how == "killed":
            kill(origin)
        else:
            origin.process.send_signal(real_caches.signal.SIGSTOP)
        cached = Load(house, proxy.port, 60, f"zipf:{house.warm}", "--arrivals", "4",
                      "--concurrency", "8")
        time.sleep(1)
        waiting = Load(house, proxy.port, 6, f"each:{house.cold}")
        report = cached.end()  # while the origin is away
        assert report["errors"] == {} and report["resumed"] == 0, report
        assert waiting.process.poll() is None
        time.sleep(max(0.0, begin + AWAY_SECONDS - time.monotonic()))
        since = time.monotonic()
        if how == "killed":
            origin = house.serve(port=origin.port)
        else:
            origin.process.send_signal(real_caches.signal.SIGCONT)
        recovered = prober.wait(since)
        waited = waiting.end()
        expect_equal(house, proxy.port, some_requests(house))
    finally:
        prober.end()
        origin.process.send_signal(real_caches.signal.SIGCONT)
        proxy.stop()
        origin.stop()
    seen = f"of what is cached: {sum_up([report])} meanwhile; of the rest: {sum_up([waited])}"
    return [(f"origin {how} for {AWAY_SECONDS} s", seen, recovered)]


def hostile(house, name):
    """Receivers behind a proxy whose upstream spoils answers, and receivers without a proxy."""
    fault, times = FAULTS[name]
    behind = HostileRelay(house.service.port, fault, times)
    # A receiver gives a silent server 15 seconds each time: not for everything in turn.
    kinds = {"kinds": ("splits", "chunk")} if name == "slow: silent" else {}
    direct = [HostileRelay(house.service.port, fault, times, **kinds) for _ in range(2)]
    for relay in (behind, *direct):
        relay.revision = fixed_part(house.service.port).rsplit("/", 1)[1]
        relay.outdated = house.outdated.port
        relay.outdated_revision = fixed_part(house.outdated.port).rsplit("/", 1)[1]
    proxy = house.proxy(behind.port, "--timeout", "2")
    label = name.replace(":", "").replace(" ", "-").replace(",", "")
    try:
        load = Load(house, proxy.port, 6, f"each:{house.warm}")
        wholes = [WholeMesh(house, proxy.port, f"{label}-proxy", "chunks"),
                  WholeMesh(house, direct[0].port, f"{label}-exact"),
                  WholeMesh(house, direct[1].port, f"{label}-chunks", "chunks")]
        report = load.end()
        whole = [whole.end() for whole in wholes]
        touched = list(behind.touched)
        expect_equal(house, proxy.port, some_requests(house) + touched)
        assert touched and all(relay.touched for relay in direct), "nothing was spoilt"
    finally:
        assert proxy.stop() == 0
        for relay in (behind, *direct):
            relay.stop()
    seen = (f"proxy: {sum_up([report])}, 1 exact; none: 2 exact, "
            f"{sum(r for r, _ in whole[1:])} times resumed, {sum(d for _, d in whole[1:])} damaged")
    mended = [seconds for relay in (behind, *direct) for seconds in relay.mended]
    return [(name, seen, max(mended, default=0.0))]


ROWS = {
    "replica": replica_killed,
    "proxy": proxy_killed,
    "origin killed": lambda house: origin_away(house, "killed"),
    "origin silent": lambda house: origin_away(house, "silent"),
    **{name: (lambda house, name=name: hostile(house, name)) for name in FAULTS},
}


def table(rows):
    lines = [("fault", "what receivers saw", "recovered in")]
    lines += [(fault, seen, seconds if isinstance(seconds, str) else f"{seconds:.1f} s")
              for fault, seen, seconds in rows]
    widths = [max(len(line[i]) for line in lines) for i in range(3)]
    return "\n".join(" | ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip()
                     for line in lines)


def main():
    wanted = sys.argv[2:] or list(ROWS)
    folder = tempfile.mkdtemp(prefix="meshfront-")
    os.chmod(folder, 0o755)
    results, failures = {}, []

    def run(house, name):
        try:
            results[name] = ROWS[name](house)
            print(table(results[name]).splitlines()[1], flush=True)
        except Exception:  # pylint: disable=broad-except
            failures.append(name)
            results[name] = [(name, "FAILED", "-")]
            print(f"--- {name}\n{traceback.format_exc()}", flush=True)

    try:
        house = House(sys.argv[1], folder)
        # The long ones begin first; the others a few at a time, so that none waits for the machine.
        long_ones = [name for name in wanted if name in list(ROWS)[:4] or name == "slow: silent"]
        turns = threading.Semaphore(4)

        def run_in_turn(name):
            with turns:
                run(house, name)

        threads = [threading.Thread(target=run, args=(house, name)) for name in long_ones]
        threads += [threading.Thread(target=run_in_turn, args=(name,)) for name in wanted
                    if name not in long_ones]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        statuses = house.stop()
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print(table([row for name in wanted for row in results[name]]))
    sys.exit(0 if not failures and statuses == [0, 0] else 1)


if __name__ == "__main__":
    main()
