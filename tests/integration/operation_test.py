#!/usr/bin/env python3
"""What an operator counts on, held against the real programs.

    operation_test.py BIN_FOLDER

Packs that come, go, are replaced and are broken while requests run; clients that are too slow or
too many; the end in the midst of answers; the access log; the metrics; that the service needs no
right to write. Waits for what is to happen, never for how soon. Standard library only.
"""
import contextlib
import http.client
import json
import os
import re
import shutil
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import threading
import time
import unittest

NOBODY = 65534


class Program:
    def __init__(self, *command, prefix=()):
        self.errors = tempfile.TemporaryFile(mode="w+")
        self.process = subprocess.Popen([*prefix, *command], stdout=subprocess.PIPE,
                                        stderr=self.errors, text=True)
        line = self.process.stdout.readline()
        match = re.fullmatch(r"listening on http://127\.0\.0\.1:(\d+)\n", line)
        if not match:
            self.process.kill()
            raise RuntimeError(f"{command[0]} said {line!r} and {self.said()}")
        self.port = int(match.group(1))

    def said(self):
        self.errors.seek(0)
        return self.errors.read()

    def signal(self, number):
        self.process.send_signal(number)

    def stop(self):
        if self.process.poll() is None:
            self.signal(signal.SIGTERM)
        status = self.process.wait(timeout=60)
        self.process.stdout.close()
        return status


def ask(port, target, method="GET", body=None, headers=None):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=120)
    with contextlib.closing(connection):
        connection.request(method, target, body, headers or {})
        response = connection.getresponse()
        return response.status, response.read(), {k.lower(): v for k, v in response.getheaders()}


def raw_connection(port, receive_buffer=0):
    connection = socket.socket()
    if receive_buffer:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
    connection.settimeout(120)
    connection.connect(("127.0.0.1", port))
    return connection


def all_from(connection):
    """What comes until the other side closes, also by a reset."""
    received = b""
    with contextlib.suppress(ConnectionError):
        while block := connection.recv(1 << 16):
            received += block
    return received


def wait_until(condition, what):
    deadline = time.monotonic() + 120
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(f"never: {what}")
        time.sleep(0.02)


def metrics(port):
    text = ask(port, "/metrics")[1].decode()
    return {name: float(value) for name, value in
            re.findall(r"^([a-z_]+(?:\{[^}]*\})?) (\S+)$", text, re.MULTILINE)}


class Operation(unittest.TestCase):
    bin = ""
    shared = ""   # a folder for all tests
    large = None  # see large_pack()

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="meshfront-")
        self.addCleanup(shutil.rmtree, self.folder)
        os.chmod(self.folder, 0o755)
        self.packs = os.path.join(self.folder, "packs")
        os.mkdir(self.packs)

    def program(self, name):
        return os.path.join(self.bin, name)

    def write_pack(self, file, name="mesh", seed=1, roots=40, depth=6):
        """Its revision. Written elsewhere and renamed into place."""
        fresh = os.path.join(self.folder, "fresh")
        done = subprocess.run([self.program("write-synthetic-pack"), fresh, name, str(seed),
                               str(roots), str(depth)], check=True, capture_output=True, text=True)
        os.replace(fresh, os.path.join(self.packs, file))
        return done.stdout.split()[1].rstrip(":")

    def write_bytes(self, file, content):
        fresh = os.path.join(self.folder, "fresh")
        with open(fresh, "wb") as out:
            out.write(content)
        os.replace(fresh, os.path.join(self.packs, file))

    def serve(self, *options, prefix=(), program=None):
        service = Program(program or self.program("meshfront-serve"), "--packs", self.packs,
                          "--listen", "127.0.0.1:0", *options, prefix=prefix)
        self.addCleanup(service.errors.close)
        self.addCleanup(service.stop)
        return service

    def proxy(self, service, *options):
        proxy = Program(self.program("meshfront-proxy"), "--upstream",
                        f"http://127.0.0.1:{service.port}", "--listen", "127.0.0.1:0", *options)
        self.addCleanup(proxy.errors.close)
        self.addCleanup(proxy.stop)
        return proxy

    def offered(self, service, mesh="mesh"):
        status, body, _ = ask(service.port, f"/v1/meshes/{mesh}")
        return json.loads(body)["revision"] if status == 200 else None

    def assert_problem(self, status, response):
        self.assertIn(f" {status} ".encode(), response.split(b"\r\n")[0])
        self.assertIn(b"application/problem+json", response)
        self.assertEqual(status, json.loads(response.split(b"\r\n\r\n", 1)[1])["status"])

    # --- packs ------------------------------------------------------------------------------------

    def large_pack(self):
        """A pack whose whole content no buffer between the programs can hold: its revision, and
        the request for all of its records."""
        if not Operation.large:
            path = os.path.join(Operation.shared, "large")
            done = subprocess.run([self.program("write-synthetic-pack"), path, "mesh", "1",
                                   str(LARGE_ROOTS), "12"], check=True, capture_output=True,
                                  text=True)
            Operation.large = path, done.stdout.split()[1].rstrip(":")
        path, revision = Operation.large
        os.link(path, os.path.join(self.packs, "large.pack"))
        content = all_roots(LARGE_ROOTS)
        head = (f"QUERY /v1/meshes/mesh/{revision}/splits?levels=63 HTTP/1.1\r\nHost: x\r\n"
                f"Content-Type: application/octet-stream\r\nContent-Length: {len(content)}\r\n"
                "Connection: close\r\n\r\n")
        return revision, head.encode() + content

    def answer_to(self, service, request):
        with contextlib.closing(raw_connection(service.port)) as connection:
            connection.sendall(request)
            return all_from(connection).split(b"\r\n\r\n", 1)[1]

    def test_a_pack_is_replaced_while_it_is_downloaded(self):
        old, request = self.large_pack()
        service = self.serve("--rescan", "0", "--grace", "0")
        whole = self.answer_to(service, request)
        self.assertGreater(len(whole), 4 << 20)
        with contextlib.closing(raw_connection(service.port, 4096)) as connection:
            connection.sendall(request)
            received = connection.recv(1000)
            new = self.write_pack("large.pack", seed=2)
            service.signal(signal.SIGHUP)
            wait_until(lambda: self.offered(service) == new, "the new revision is offered")
            self.assertEqual(404, ask(service.port, f"/v1/meshes/mesh/{old}/base")[0])
            self.assertGreaterEqual(metrics(service.port)["meshfront_requests_in_flight"], 2)
            received += all_from(connection)
        self.assertEqual(whole, received.split(b"\r\n\r\n", 1)[1])

    def test_packs_are_taken_up_without_being_told(self):
        service = self.serve("--rescan", "0.1")
        proxy = self.proxy(service)
        empty = ask(service.port, "/v1/meshes")
        self.assertEqual([], json.loads(empty[1])["meshes"])
        first = self.write_pack("a.pack", seed=1)
        wait_until(lambda: self.offered(service) == first, "a new pack")
        catalogue = ask(service.port, "/v1/meshes")
        self.assertNotEqual(empty[2]["etag"], catalogue[2]["etag"])
        unchanged = ask(service.port, "/v1/meshes", headers={"If-None-Match": catalogue[2]["etag"]})
        self.assertEqual(304, unchanged[0])
        base = ask(proxy.port, f"/v1/meshes/mesh/{first}/base")
        self.assertEqual(200, base[0])

        second = self.write_pack("a.pack", seed=2)
        wait_until(lambda: self.offered(service) == second, "a replaced pack")
        self.assertNotEqual(catalogue[2]["etag"], ask(service.port, "/v1/meshes")[2]["etag"])
        # Receivers in the midst of the old one can finish.
        for server in (service, proxy):
            self.assertEqual(base[1], ask(server.port, f"/v1/meshes/mesh/{first}/base")[1])
        self.assertEqual(200, ask(proxy.port, f"/v1/meshes/mesh/{second}/base")[0])

        os.remove(os.path.join(self.packs, "a.pack"))
        wait_until(lambda: self.offered(service) is None, "a removed pack")
        self.assertEqual([], json.loads(ask(service.port, "/v1/meshes")[1])["meshes"])
        self.assertEqual(200, ask(service.port, f"/v1/meshes/mesh/{second}/base")[0])
        self.assertEqual(2, metrics(service.port)["meshfront_revisions_retired"])

    def test_a_broken_pack_is_reported_once_and_changes_nothing(self):
        revision = self.write_pack("a.pack")
        service = self.serve("--rescan", "0.05")
        self.write_bytes("a.pack", b"no pack" * 1000)
        wait_until(lambda: metrics(service.port)["meshfront_packs_broken"] == 1, "it is counted")
        time.sleep(0.3)  # some more looks at it
        self.assertEqual(revision, self.offered(service))
        self.assertEqual(200, ask(service.port, f"/v1/meshes/mesh/{revision}/base")[0])
        self.assertEqual(1, service.said().count("its former content stays in service"))
        self.assertEqual(1, metrics(service.port)["meshfront_pack_failures_total"])
        mended = self.write_pack("a.pack", seed=3)
        wait_until(lambda: self.offered(service) == mended, "the mended pack")
        self.assertEqual(0, metrics(service.port)["meshfront_packs_broken"])

    # --- clients ----------------------------------------------------------------------------------

    def test_slow_senders_are_cut_and_others_served(self):
        revision = self.write_pack("a.pack")
        service = self.serve("--header-timeout", "0.5", "--content-timeout", "0.5")
        target = f"/v1/meshes/mesh/{revision}/splits"
        beginnings = (b"", b"GET /v1/meshes HTTP/1.1\r\nHost: x\r\nA: ",
                      f"QUERY {target} HTTP/1.1\r\nHost: x\r\nContent-Type: "
                      "application/octet-stream\r\nContent-Length: 100000\r\n\r\n".encode())
        answers = [b""] * 3 * len(beginnings)

        def trickle(number):
            with contextlib.closing(raw_connection(service.port)) as slow:
                slow.sendall(beginnings[number % len(beginnings)])
                slow.settimeout(0.05)
                with contextlib.suppress(ConnectionError):
                    while True:
                        with contextlib.suppress(TimeoutError):
                            answers[number] = slow.recv(1 << 16)
                            return
                        slow.sendall(b"x")

        threads = [threading.Thread(target=trickle, args=(n,)) for n in range(len(answers))]
        for thread in threads:
            thread.start()
        while any(thread.is_alive() for thread in threads):
            self.assertEqual(200, ask(service.port, f"/v1/meshes/mesh/{revision}/base")[0])
            time.sleep(0.02)
        for answer in answers:
            self.assert_problem(408, answer)
        counted = metrics(service.port)
        for phase in ("line", "header", "content"):
            self.assertEqual(3, counted[f'meshfront_cut_total{{phase="{phase}"}}'])

    def test_too_many_connections_from_an_address(self):
        self.write_pack("a.pack")
        service = self.serve("--max-connections-per-address", "4")
        for server in (service, self.proxy(service, "--max-connections-per-address", "4")):
            with contextlib.ExitStack() as stack:
                held = [http.client.HTTPConnection("127.0.0.1", server.port, timeout=120)
                        for _ in range(3)]
                for connection in held:
                    stack.enter_context(contextlib.closing(connection))
                    connection.request("GET", "/healthz")
                    self.assertEqual(b"ok\n", connection.getresponse().read())
                self.assertEqual(200, ask(server.port, "/healthz")[0])

                def are_open(count, over=held[0]):
                    over.request("GET", "/metrics")
                    text = over.getresponse().read().decode()
                    return f"\nmeshfront_connections_open {count}\n" in text

                wait_until(lambda: are_open(3), "three connections")
                with contextlib.closing(raw_connection(server.port)) as fourth:
                    fourth.sendall(b"GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n")
                    self.assertIn(b" 200 ", fourth.recv(1 << 16))
                    with contextlib.closing(raw_connection(server.port)) as fifth:
                        fifth.sendall(b"GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n")
                        refused = all_from(fifth)
                        self.assert_problem(429, refused)
                        self.assertIn(b"\r\nRetry-After: ", refused)
                for connection in held:
                    connection.request("GET", "/healthz")
                    self.assertEqual(b"ok\n", connection.getresponse().read())

    def test_limits_of_a_request(self):
        revision = self.write_pack("a.pack")
        service = self.serve("--max-ids", "10", "--max-levels", "2", "--max-records", "30",
                             "--max-header", "16KiB", "--max-content", "2KiB")
        fixed = f"/v1/meshes/mesh/{revision}/splits"
        binary = {"Content-Type": "application/octet-stream"}

        def query(content, parameter=""):
            status, body, headers = ask(service.port, fixed + parameter, "QUERY", content, binary)
            if status != 200:
                self.assertEqual("application/problem+json", headers["content-type"])
                self.assertEqual(status, json.loads(body)["status"])
            return status

        self.assertEqual(200, query(all_roots(12)))  # two of these are leaves: 10 nodes
        self.assertEqual(413, query(all_roots(13)))
        self.assertEqual(200, query(bytes([0x98]), "?levels=2"))
        self.assertEqual(413, query(bytes([0x98]), "?levels=3"))
        self.assertEqual(413, query(all_roots(12), "?levels=2"))  # more than 30 records
        self.assertEqual(413, query(bytes(2049)))
        self.assertEqual(400, query(bytes(2048)))
        self.assertEqual(431, ask(service.port, "/v1/meshes", headers={"A": "b" * 17000})[0])
        self.assertEqual(414, ask(service.port, "/" + "a" * 8000)[0])
        self.assertEqual(404, ask(service.port, "/" + "a" * 7999)[0])

    def test_the_end_in_the_midst_of_answers(self):
        _, request = self.large_pack()
        service = self.serve()
        whole = self.answer_to(service, request)
        with contextlib.closing(raw_connection(service.port, 4096)) as connection:
            connection.sendall(request)
            received = connection.recv(1000)
            service.signal(signal.SIGTERM)
            received += all_from(connection)
        self.assertEqual(0, service.stop())
        # Whole, unless this machine took more than the 3 seconds that the service waits.
        content = received.split(b"\r\n\r\n", 1)[1]
        self.assertTrue(whole.startswith(content))
        self.assertIn(f"Content-Length: {len(whole)}\r\n".encode(), received)
        with socket.socket() as late, self.assertRaises(ConnectionRefusedError):
            late.connect(("127.0.0.1", service.port))

    # --- what is told -----------------------------------------------------------------------------

    def test_the_access_log(self):
        self.write_pack("a.pack")
        texts = os.path.join(self.folder, "text.log")
        objects = os.path.join(self.folder, "json.log")
        service = self.serve("--access-log", texts)
        proxy = self.proxy(service, "--access-log", objects, "--access-log-format", "json")

        def lines(path):
            with open(path, encoding="ascii") as log:
                return log.read().splitlines()

        ask(service.port, "/v1/meshes/mesh")
        wait_until(lambda: len(lines(texts)) == 1, "a line")
        ask(service.port, "/none", "HEAD")
        wait_until(lambda: len(lines(texts)) == 2, "two lines")
        with contextlib.closing(raw_connection(service.port)) as connection:
            connection.sendall(b"GET /a\"b\\\xff HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
            all_from(connection)
        wait_until(lambda: len(lines(texts)) == 3, "three lines")
        pattern = (r'127\.0\.0\.1 - - \[\d\d/[A-Z][a-z]{2}/\d{4}:\d\d:\d\d:\d\d \+0000\] '
                   r'"(.*) HTTP/1\.1" (\d+) (\d+) \d+\.\d{6}')
        parts = [re.fullmatch(pattern, line).groups() for line in lines(texts)]
        size = len(ask(service.port, "/v1/meshes/mesh")[1])
        self.assertEqual(("GET /v1/meshes/mesh", "200", str(size)), parts[0])
        self.assertEqual(("HEAD /none", "404", "0"), parts[1])
        self.assertEqual((r"GET /a\x22b\x5C\xFF", "404"), parts[2][:2])

        ask(proxy.port, "/v1/meshes/mesh?x")
        wait_until(lambda: len(lines(objects)) == 1, "a line")
        entry = json.loads(lines(objects)[0])
        self.assertEqual(["time", "address", "method", "target", "status", "bytes", "seconds",
                          "whole"], list(entry))
        self.assertEqual(("GET", "/v1/meshes/mesh?x", 400, True),
                         (entry["method"], entry["target"], entry["status"], entry["whole"]))

        # Moved away and opened anew.
        for server, path in ((service, texts), (proxy, objects)):
            os.rename(path, path + ".1")
            server.signal(signal.SIGHUP)
            wait_until(lambda: os.path.exists(path), "the log is opened anew")
            ask(server.port, "/healthz")
            wait_until(lambda: any("/healthz" in line for line in lines(path)), "a new line")
            self.assertFalse(any("/healthz" in line for line in lines(path + ".1")))

    def test_the_access_log_on_standard_output(self):
        service = self.serve("--access-log", "-")
        ask(service.port, "/healthz")
        self.assertIn('"GET /healthz HTTP/1.1" 200 3 ', service.process.stdout.readline())

    def test_every_metric_is_explained(self):
        revision = self.write_pack("a.pack")
        service = self.serve()
        proxy = self.proxy(service)
        ask(proxy.port, f"/v1/meshes/mesh/{revision}/splits", "QUERY", bytes([0x98]),
            {"Content-Type": "application/octet-stream"})
        expected = {"requests_total", "requested_ids_total", "records_total", "record_bytes_total",
                    "chunk_bytes_total", "request_seconds", "requests_in_flight",
                    "in_flight_bytes", "connections_open", "connections_total", "refused_total",
                    "cut_total", "unfinished_total"}
        own = ({"index_bytes", "index_hits_total", "index_misses_total", "index_chunks_total",
                "index_evicted_chunks_total", "index_evicted_bytes_total", "meshes",
                "packs_broken", "packs_loaded_total", "pack_failures_total", "revisions_retired"},
               {"cache_bytes", "cache_evicted_bytes_total", "cache_record_hits_total",
                "cache_record_misses_total", "upstream_seconds", "upstream_in_flight",
                "upstream_failures_total", "upstream_requests_total"})
        for server, names in zip((service, proxy), own):
            text = ask(server.port, "/metrics")[1].decode()
            helped = set(re.findall(r"^# HELP meshfront_(\S+) \S.*\.$", text, re.MULTILINE))
            typed = set(re.findall(r"^# TYPE meshfront_(\S+) (?:counter|gauge|histogram)$", text,
                                   re.MULTILINE))
            shown = {re.sub(r"_(bucket|sum|count)$", "", name) for name in
                     re.findall(r"^meshfront_([a-z_]+)", text, re.MULTILINE)}
            self.assertEqual(set(), (expected | names) - helped)
            self.assertEqual(helped, typed)
            self.assertEqual(set(), shown - helped)
        wait_until(lambda: metrics(service.port)["meshfront_index_misses_total"] == 1, "a miss")
        self.assertGreater(metrics(proxy.port)["meshfront_upstream_seconds_count"], 0)
        self.assertGreater(metrics(proxy.port)["meshfront_request_seconds_sum"], 0)

    def test_help_shows_the_limits(self):
        for program in ("meshfront-serve", "meshfront-proxy"):
            done = subprocess.run([self.program(program), "--help"], capture_output=True, text=True)
            self.assertEqual(0, done.returncode)
            for part in ("Limits:", "--max-content SIZE=1MiB", "--header-timeout SECONDS=10",
                         "--access-log FILE"):
                self.assertIn(part, done.stdout)

    # --- rights -----------------------------------------------------------------------------------

    def test_it_needs_no_right_to_write(self):
        revision = self.write_pack("a.pack")
        os.chmod(self.packs, 0o555)
        self.addCleanup(os.chmod, self.packs, 0o755)
        prefix = ()
        program = shutil.copy(self.program("meshfront-serve"), self.folder)
        if os.geteuid() == 0:
            prefix = ("setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups",
                      "--no-new-privs", "--bounding-set=-all")
        before = sorted(os.listdir(self.packs))
        service = self.serve("--rescan", "0.1", prefix=prefix, program=program)
        process = f"/proc/{service.process.pid}"
        self.assertEqual(200, ask(service.port, f"/v1/meshes/mesh/{revision}/base")[0])
        self.assertEqual(200, ask(service.port, f"/v1/meshes/mesh/{revision}/chunks/0")[0])
        if os.geteuid() == 0:
            with open(f"{process}/status", encoding="ascii") as status:
                self.assertIn(f"Uid:\t{NOBODY}\t{NOBODY}\t{NOBODY}\t{NOBODY}\n", status.read())
        self.assertEqual(before, sorted(os.listdir(self.packs)))
        opened = 0
        for number in os.listdir(f"{process}/fd"):
            with contextlib.suppress(FileNotFoundError):
                if os.readlink(f"{process}/fd/{number}").startswith(self.packs):
                    opened += 1
                    rights = os.lstat(f"{process}/fd/{number}").st_mode
                    self.assertFalse(rights & stat.S_IWUSR)
        self.assertGreater(opened, 0)
        with open(f"{process}/maps", encoding="utf-8") as maps:
            mapped = [line.split()[1] for line in maps if self.packs in line]
        self.assertEqual({"r--s"}, set(mapped))

    def test_names_never_touch_paths(self):
        self.write_pack("a.pack")
        outside = self.write_pack("../outside.pack", name="outside")
        service = self.serve()
        with contextlib.closing(raw_connection(service.port)):
            for name in ("..%2foutside", "..%2Foutside.pack", "../outside", "..", ".", "%2e%2e",
                         "..%5coutside", "outside", "outside.pack", "a.pack", "packs%2fa.pack",
                         "..%2f..%2f..%2f..%2fetc%2fpasswd", "%00", "mesh%00", "%2fetc%2fpasswd",
                         "/etc/passwd", "mesh%2f..%2f..%2foutside"):
                for rest in ("", f"/{outside}/base", f"/{outside}/chunks/0", "/../base"):
                    status, body, headers = ask(service.port, f"/v1/meshes/{name}{rest}")
                    self.assertEqual(404, status, name + rest)
                    self.assertEqual("application/problem+json", headers["content-type"])
                    self.assertNotIn(self.folder.encode(), body)


LARGE_ROOTS = 4000


def exp_golomb(value, order):
    value += 1 << order
    return "0" * (value.bit_length() - order - 1) + format(value, "b")


def all_roots(count):
    """The bitstring of trees 0 to count - 1 but for 3 and 4, which are leaves."""
    trees = [tree for tree in range(count) if tree not in (3, 4)]
    bits = exp_golomb(len(trees), 3)
    following = 0
    for tree in trees:
        bits += exp_golomb(tree - following, 0) + "00"
        following = tree + 1
    bits += "0" * (-len(bits) % 8)
    return bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8))


if __name__ == "__main__":
    Operation.bin = sys.argv[1]
    with tempfile.TemporaryDirectory(prefix="meshfront-") as Operation.shared:
        unittest.main(argv=sys.argv[:1], verbosity=2)
