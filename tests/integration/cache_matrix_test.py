#!/usr/bin/env python3
"""Real caches in front of the real service, with the configurations that deploy/ ships.

    cache_matrix_test.py BIN_FOLDER

Two replicas of meshfront-serve stand behind each of nginx, Varnish, Squid and HAProxy (with
meshfront-proxy); each check is made for each of them, and the last lines printed are the matrix.
Bodies are compared with those of the service asked directly. A program that is not installed fails.
"""
import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import real_caches
from node_sets import bitstring, ids
from running_programs import BINARY, Program, ask, counters

MAX_TARGET = 8000
CHECKS = ("MISS, then HIT", "304 by ETag", "50 for a cold chunk", "URL of 8,000 octets",
          "no Vary, Set-Cookie", "QUERY", "TLS, HTTP/2")
results = {}  # (cache, check): what was seen


class Origin:
    """Two replicas and what they hold."""

    def __init__(self, bin_folder, folder):
        packs = os.path.join(folder, "packs")
        os.mkdir(packs)
        for name, roots, depth in (("deep", "60", "9"), ("wide", "21000", "1")):
            subprocess.run([os.path.join(bin_folder, "write-synthetic-pack"),
                            os.path.join(packs, f"{name}.pack"), name, "7", roots, depth],
                           check=True, stdout=subprocess.DEVNULL)
        self.replicas = [Program(os.path.join(bin_folder, "meshfront-serve"), "--packs", packs,
                                 "--listen", "127.0.0.1:0") for _ in range(2)]
        self.ports = [replica.port for replica in self.replicas]
        self.deep, self.wide = (self.fixed_part(mesh) for mesh in ("deep", "wide"))

    def fixed_part(self, mesh):
        link = json.loads(ask(self.ports[0], f"/v1/meshes/{mesh}").body)["links"]["base"]
        return link.removesuffix("/base")

    def body(self, target, method="GET", content=None):
        headers = {"Content-Type": BINARY} if content is not None else None
        bodies = {ask(port, target, method, content, headers).body for port in self.ports}
        assert len(bodies) == 1, "replicas differ"
        return bodies.pop()

    def requests(self, *routes):
        """Answered by both for resources named so."""
        return sum(value for port in self.ports for name, value in counters(port).items()
                   if any(f'route="{route}"' in name for route in routes))

    @contextlib.contextmanager
    def paused(self):
        """Its connections are taken and not answered."""
        for replica in self.replicas:
            replica.process.send_signal(signal.SIGSTOP)
        for replica in self.replicas:  # until then, some of its threads go on
            os.waitid(os.P_PID, replica.process.pid, os.WSTOPPED)
        try:
            yield
        finally:
            for replica in self.replicas:
                replica.process.send_signal(signal.SIGCONT)

    def long_target(self, length):
        """A URL for records of exactly so many octets."""
        prefix = f"{self.wide}/splits/"
        for suffix in ("", "?levels=1", "?significance=0"):
            octets = length - len(prefix) - len(suffix)
            if octets % 4 == 1:  # no base64 is as long
                continue
            # A root next to the last one takes three bits, the number of roots 27 or 28.
            count = (octets * 6 // 8 * 8 - 28) // 3
            target = prefix + ids([(tree, "") for tree in range(5, 5 + count)]) + suffix
            if len(target) == length:
                return target
        raise AssertionError(f"no set makes a URL of {length} octets")

    def stop(self):
        return [replica.stop() for replica in self.replicas]


class CacheChecks:
    """Each check uses chunks that no other one asks for."""
    kind = None
    origin = None
    folder = ""
    bin = ""

    @classmethod
    def setUpClass(cls):
        cls.cache = cls.kind(cls.folder, cls.bin, cls.origin.ports)

    @classmethod
    def tearDownClass(cls):
        cls.cache.stop()

    def see(self, check, what):
        results[self.kind.name, check] = what

    def get(self, target, method="GET", body=None, headers=None):
        return ask(self.cache.port, target, method, body, headers)

    def test_1_miss_then_hit(self):
        target = f"{self.origin.deep}/chunks/10"
        expected = self.origin.body(target)
        asked = self.origin.requests("chunk")
        seen = []
        for headers in ({}, {}, {"Cookie": "a=b", "Authorization": "Basic eDp5",
                                 "Cache-Control": "no-cache", "Accept-Encoding": "gzip"}):
            before = self.cache.tally()
            response = self.get(target, headers=headers)
            self.assertEqual(200, response.status)
            self.assertEqual(expected, response.body)
            self.assertEqual("public, max-age=31536000, immutable, no-transform",
                             response.headers["cache-control"])
            seen.append("HIT" if self.cache.is_hit(response, before) else "MISS")
        self.assertEqual(["MISS", "HIT", "HIT"], seen)
        self.assertEqual(asked + 1, self.origin.requests("chunk"))
        for resource in ("/base", "/chunks", f"/splits/{ids([(7, ''), (8, '')])}?levels=3"):
            expected = self.origin.body(self.origin.deep + resource)
            for _ in range(2):
                self.assertEqual(expected, self.get(self.origin.deep + resource).body)
        self.see(CHECKS[0], ", ".join(seen) + "; origin 1 of 3")

    def test_2_not_modified(self):
        target = f"{self.origin.deep}/chunks/20"
        whole = self.get(target)
        tag = whole.headers["etag"]
        asked = self.origin.requests("chunk")
        for condition in (tag, f'"other", {tag}', f"W/{tag}", "*"):
            for method in ("GET", "HEAD"):
                response = self.get(target, method, headers={"If-None-Match": condition})
                self.assertEqual(304, response.status, condition)
                if self.kind.etag_in_304 or "etag" in response.headers:
                    self.assertEqual(tag, response.headers["etag"])
                self.assertEqual(b"", response.body)
        other = self.get(target, headers={"If-None-Match": '"other"'})
        self.assertEqual((200, whole.body), (other.status, other.body))
        self.assertEqual(asked, self.origin.requests("chunk"))
        # Also where the cache has to ask first.
        target = f"{self.origin.deep}/chunks/21"
        tag = ask(self.origin.ports[0], target).headers["etag"]
        cold = self.get(target, headers={"If-None-Match": tag})
        self.assertEqual((304, b""), (cold.status, cold.body))
        self.see(CHECKS[1], "304; origin 0 of 9")

    def test_3_many_for_a_cold_chunk(self):
        target = f"{self.origin.deep}/chunks/30"
        expected = self.origin.body(target)
        asked = self.origin.requests("chunk")
        bodies = []
        threads = [threading.Thread(target=lambda: bodies.append(self.get(target).body))
                   for _ in range(50)]
        with self.origin.paused():
            for thread in threads:
                thread.start()
            time.sleep(0.4)  # all have come, none can have been answered
            self.assertEqual([], bodies)
        for thread in threads:
            thread.join()
        self.assertEqual([expected] * 50, bodies)
        self.assertEqual(asked + 1, self.origin.requests("chunk"))
        self.see(CHECKS[2], "origin 1 of 50")

    def test_4_url_at_the_limit(self):
        target = self.origin.long_target(MAX_TARGET)
        expected = self.origin.body(target)
        self.assertGreater(len(expected), 10000)
        response = self.get(target)
        self.assertEqual((200, expected), (response.status, response.body))
        for octets, status in ((MAX_TARGET + 1, 414), (9000, self.kind.refuses_long_urls)):
            refused = self.get(self.origin.long_target(octets))
            self.assertEqual(status, refused.status, octets)
            self.assertNotIn("vary", refused.headers)
        self.see(CHECKS[3], "200; 8,001: 414")

    def test_5_no_vary_or_cookies(self):
        chunk = f"{self.origin.deep}/chunks/50"
        tag = self.get(chunk).headers["etag"]
        splits = f"{self.origin.deep}/splits"
        requests = [
            (200, (chunk,)), (200, (chunk, "HEAD")),
            (304, (chunk, "GET", None, {"If-None-Match": tag})),
            (200, ("/v1/meshes",)), (200, ("/v1/meshes/deep",)), (200, ("/healthz",)),
            (200, (f"{splits}/{ids([(7, '')])}",)), (400, (f"{splits}/=",)),
            (404, ("/v1/meshes/none",)), (404, (f"{self.origin.deep}/chunks/99999",)),
            (405, (chunk, "POST", b"")), (204, (splits, "OPTIONS")),
            (415, (splits, "QUERY", b"x", {"Content-Type": "text/plain"})),
        ]
        for status, request in requests:
            for headers in ({"Origin": "http://viewer.example"}, {"Accept-Encoding": "gzip, br"}):
                target, method, body, own = (*request, *("GET", None, {})[len(request) - 1:])
                response = self.get(target, method, body, {**own, **headers})
                self.assertEqual(status, response.status, request)
                self.assertNotIn("vary", response.headers, request)
                self.assertNotIn("set-cookie", response.headers, request)
                self.assertNotIn("content-encoding", response.headers, request)
                self.assertEqual("*", response.headers["access-control-allow-origin"], request)
        self.assertIn(self.get("/metrics").status, (403, 404))  # the operator's alone
        self.see(CHECKS[4], f"none in {2 * len(requests)}")

    def test_6_query_passes(self):
        target = f"{self.origin.wide}/splits"
        sets = [bitstring([(tree, "") for tree in range(*bounds)])
                for bounds in ((5, 12), (9000, 9100), (5, 12000), (5, 20500))]
        self.assertTrue(3500 < len(sets[2]) < 5500)  # its URL, in an answer's field, would be too long
        self.assertGreater(len(sets[3]), 6000)  # as a URL it would be too long
        expected = [self.origin.body(target, "QUERY", content) for content in sets]
        asked = self.origin.requests("query-splits", "splits")
        for _ in range(2):
            for content, answer in zip(sets, expected):
                response = self.get(target, "QUERY", content, {"Content-Type": BINARY})
                self.assertEqual(200, response.status)
                self.assertEqual(answer, response.body)
                self.assertEqual(len(content) < 1400, "content-location" in response.headers)
        through = self.origin.requests("query-splits", "splits") - asked
        too_much = self.get(target, "QUERY", b"\0" * ((1 << 20) + 1), {"Content-Type": BINARY})
        self.assertEqual(413, too_much.status)
        self.assert_query_cost(through)
        self.see(CHECKS[5], f"right; origin {through} of 8")

    def assert_query_cost(self, through):
        self.assertEqual(8, through)  # none was cached

    def over_tls(self, target, *options):
        """Status and body by HTTP/2 over TLS."""
        out = os.path.join(self.cache.folder, "tls-answer")
        done = subprocess.run(
            ["curl", "--silent", "--show-error", "--insecure", "--http2", "--output", out,
             "--write-out", "%{http_version} %{http_code}", *options,
             f"https://127.0.0.1:{self.cache.tls_port}{target}"], capture_output=True, text=True)
        self.assertEqual("", done.stderr)
        version, status = done.stdout.split()
        self.assertEqual("2", version)
        with open(out, "rb") as file:
            return int(status), file.read()

    def test_7_tls_and_http2(self):
        if self.cache.tls_port is None:
            self.see(CHECKS[6], "none: one before it")
            return
        longest = self.origin.long_target(MAX_TARGET)
        for target in (f"{self.origin.deep}/chunks/70", longest, "/v1/meshes/deep"):
            self.assertEqual((200, self.origin.body(target)), self.over_tls(target))
        self.assertEqual(414, self.over_tls(self.origin.long_target(MAX_TARGET + 1))[0])
        content = bitstring([(tree, "") for tree in range(5, 20500)])
        path = os.path.join(self.cache.folder, "tls-content")
        with open(path, "wb") as file:
            file.write(content)
        target = f"{self.origin.wide}/splits"
        answer = self.over_tls(target, "--request", "QUERY", "--header", f"Content-Type: {BINARY}",
                               "--data-binary", f"@{path}")
        self.assertEqual((200, self.origin.body(target, "QUERY", content)), answer)
        # One cache for both: what came over TLS is there without.
        asked = self.origin.requests("chunk")
        self.assertEqual(200, self.get(f"{self.origin.deep}/chunks/70").status)
        self.assertEqual(asked, self.origin.requests("chunk"))
        self.see(CHECKS[6], "200, 414, QUERY")


class NginxTest(CacheChecks, unittest.TestCase):
    kind = real_caches.Nginx


class VarnishTest(CacheChecks, unittest.TestCase):
    kind = real_caches.Varnish


class SquidTest(CacheChecks, unittest.TestCase):
    kind = real_caches.Squid


class HAProxyTest(CacheChecks, unittest.TestCase):
    kind = real_caches.HAProxy

    def assert_query_cost(self, through):
        # HAProxy passes all of them; behind it meshfront-proxy knows QUERY and holds the records.
        # Each of two proxies may have been asked.
        self.assertLessEqual(through, 8)


def matrix():
    kinds = (real_caches.Nginx, real_caches.Varnish, real_caches.Squid, real_caches.HAProxy)
    rows = [("", *CHECKS)]
    for kind in kinds:
        rows.append((kind.name, *(results.get((kind.name, check), "FAILED") for check in CHECKS)))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return "\n".join(" | ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
                     for row in rows)


def main():
    CacheChecks.bin = sys.argv[1]
    CacheChecks.folder = tempfile.mkdtemp(prefix="meshfront-")
    os.chmod(CacheChecks.folder, 0o755)
    try:
        CacheChecks.origin = Origin(CacheChecks.bin, CacheChecks.folder)
        try:
            done = unittest.main(argv=sys.argv[:1], verbosity=2, exit=False)
        finally:
            statuses = CacheChecks.origin.stop()
    finally:
        shutil.rmtree(CacheChecks.folder, ignore_errors=True)
    print(matrix())
    sys.exit(0 if done.result.wasSuccessful() and statuses == [0, 0] else 1)


if __name__ == "__main__":
    main()
