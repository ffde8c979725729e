#!/usr/bin/env python3
"""Two proxies, one behind the other, and what a proxy passes on of fields and refusals.

    proxy_chain_test.py BIN_FOLDER
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from node_sets import bitstring, ids
from running_programs import BINARY, Program, ask, counters

# Of one connection alone (RFC 9110 section 7.6.1), or of one client alone.
OF_NOBODY_ELSE = ("connection", "keep-alive", "te", "trailer", "upgrade", "proxy-authorization",
                  "proxy-authenticate", "proxy-connection", "cookie", "set-cookie", "vary",
                  "x-of-this-hop", "authorization")


class FieldsOnTheWay(BaseHTTPRequestHandler):
    """Notes the fields of requests, and adds to the answers what must not go further."""
    protocol_version = "HTTP/1.1"
    service = 0
    seen = []

    def do_GET(self):  # pylint: disable=invalid-name
        self.seen.append({name.lower(): value for name, value in self.headers.items()})
        answer = ask(self.service, self.path)
        self.send_response_only(answer.status)
        for name, value in answer.headers.items():
            if name not in ("connection", "date"):
                self.send_header(name, value)
        for name, value in (("Connection", "X-Of-This-Hop"), ("X-Of-This-Hop", "1"),
                            ("Keep-Alive", "timeout=5"), ("Proxy-Authenticate", "Basic"),
                            ("Set-Cookie", "a=b"), ("Vary", "Cookie"), ("Trailer", "X")):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(answer.body)

    def log_message(self, *_):
        pass


class ProxyChain(unittest.TestCase):
    bin = ""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="meshfront-")
        subprocess.run([os.path.join(cls.bin, "write-synthetic-pack"),
                        os.path.join(cls.folder, "mesh.pack"), "mesh", "7", "60", "9"], check=True,
                       stdout=subprocess.DEVNULL)
        cls.service = Program(os.path.join(cls.bin, "meshfront-serve"), "--packs", cls.folder,
                              "--listen", "127.0.0.1:0")
        cls.inner = cls.proxy_of(cls.service.port)
        cls.outer = cls.proxy_of(cls.inner.port)
        link = json.loads(ask(cls.service.port, "/v1/meshes/mesh").body)["links"]["base"]
        cls.fixed = link.removesuffix("/base")
        roots = [(tree, "") for tree in range(40)
                 if ask(cls.service.port, f"{cls.fixed}/splits/{ids([(tree, '')])}").status == 200]
        cls.targets = ["/v1/meshes", "/v1/meshes/mesh"] + [
            cls.fixed + end for end in ("/base", "/chunks", "/chunks/0", "/chunks/3",
                                        f"/splits/{ids(roots)}", f"/splits/{ids(roots)}?levels=4",
                                        f"/splits/{ids(roots[5:9])}?significance=3")]
        cls.roots = roots

    @classmethod
    def proxy_of(cls, port):
        return Program(os.path.join(cls.bin, "meshfront-proxy"), "--upstream",
                       f"http://127.0.0.1:{port}", "--listen", "127.0.0.1:0")

    @classmethod
    def tearDownClass(cls):
        statuses = [program.stop() for program in (cls.outer, cls.inner, cls.service)]
        shutil.rmtree(cls.folder)
        assert statuses == [0, 0, 0], statuses

    def test_0_tells_what_it_held(self):
        def status(roots):
            return ask(self.inner.port, f"{self.fixed}/splits/{ids(roots)}").headers["cache-status"]

        self.assertEqual("meshfront; fwd=miss", status(self.roots[:2]))
        self.assertEqual("meshfront; hit", status(self.roots[:2]))
        self.assertEqual("meshfront; fwd=partial", status(self.roots[:3]))
        answer = ask(self.service.port, f"{self.fixed}/splits/{ids(self.roots[:2])}")
        self.assertNotIn("cache-status", answer.headers)

    def test_1_both_answer_as_the_service_does(self):
        for target in self.targets:
            right = ask(self.service.port, target)
            self.assertEqual(200, right.status, target)
            for port, via in ((self.outer.port, "1.1 meshfront, 1.1 meshfront"),
                              (self.inner.port, "1.1 meshfront")):
                answer = ask(port, target)
                self.assertEqual((right.status, right.body), (answer.status, answer.body), target)
                for field in ("content-type", "cache-control", "etag"):
                    self.assertEqual(right.headers[field], answer.headers[field], target)
                self.assertEqual(via, answer.headers["via"])
                self.assertRegex(answer.headers["age"], r"^\d+$")
        content = bitstring(self.roots)
        for port in (self.outer.port, self.inner.port):
            answer = ask(port, f"{self.fixed}/splits", "QUERY", content, {"Content-Type": BINARY})
            self.assertEqual(ask(self.service.port, f"{self.fixed}/splits/{ids(self.roots)}").body,
                             answer.body)

    def test_2_age_counts_through_both(self):
        target = f"{self.fixed}/chunks/4"
        self.assertEqual(200, ask(self.inner.port, target).status)
        time.sleep(2.1)
        # New to the outer one, but two seconds old; how much more is the machine's affair.
        self.assertGreaterEqual(int(ask(self.outer.port, target).headers["age"]), 2)
        for port in (self.inner.port, self.outer.port):
            self.assertGreaterEqual(int(ask(port, f"{self.fixed}/base").headers["age"]), 2)

    def test_3_what_is_asked_again_costs_nobody_upstream_anything(self):
        for target in self.targets[2:]:
            ask(self.outer.port, target)
        before = [counters(port) for port in (self.inner.port, self.service.port)]
        for target in self.targets[2:]:
            self.assertEqual(200, ask(self.outer.port, target).status)
        after = [counters(port) for port in (self.inner.port, self.service.port)]
        for old, new in zip(before, after):
            for name, value in new.items():
                if "requests_total" in name and "metrics" not in name:
                    self.assertEqual(old[name], value, name)

    def test_4_refusals_are_kept_for_a_short_time(self):
        name = 'meshfront_requests_total{route="chunk",status="404"}'
        before = counters(self.service.port).get(name, 0)
        begin = time.monotonic()
        for _ in range(5):
            refused = ask(self.outer.port, f"{self.fixed}/chunks/4000000")
            self.assertEqual(404, refused.status)
            self.assertEqual("public, max-age=10", refused.headers["cache-control"])
        asked = counters(self.service.port).get(name, 0) - before
        # Once, and again for each ten seconds that this took, in each of two caches.
        self.assertLessEqual(asked, 1 + 2 * int((time.monotonic() - begin) / 10))

    def test_5_fields_of_one_hop_end_there(self):
        handler = type("Handler", (FieldsOnTheWay,), {"service": self.service.port, "seen": []})
        server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True).start()
        proxy = self.proxy_of(server.server_address[1])
        try:
            for target in self.targets:
                answer = ask(proxy.port, target, headers={
                    "Connection": "X-Of-This-Hop", "X-Of-This-Hop": "1", "TE": "trailers",
                    "Keep-Alive": "timeout=9", "Proxy-Authorization": "Basic eDp5",
                    "Cookie": "c=d", "Authorization": "Basic eDp5"})
                self.assertEqual(ask(self.service.port, target).body, answer.body, target)
                for name in OF_NOBODY_ELSE:
                    if name not in ("connection", "keep-alive"):  # the proxy's own, if any
                        self.assertNotIn(name, answer.headers, target)
                self.assertNotIn("X-Of-This-Hop", answer.headers.get("connection", ""))
            self.assertTrue(handler.seen)
            for fields in handler.seen:
                self.assertEqual("1.1 meshfront", fields["via"])
                for name in OF_NOBODY_ELSE:
                    self.assertNotIn(name, fields)
        finally:
            status = proxy.stop()
            server.shutdown()
            server.server_close()
        self.assertEqual(0, status)


if __name__ == "__main__":
    ProxyChain.bin = sys.argv.pop(1)
    unittest.main(verbosity=2)
