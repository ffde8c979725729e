#!/usr/bin/env python3
"""The HTTP interface, held against the real service and the real proxy in front of it.

    http_interface_test.py BIN_FOLDER [PACK]

Starts meshfront-serve over PACK (default: a synthetic one), meshfront-proxy over that, and checks
every rule of the interface against both, that both answer alike, that the second of two identical
requests costs nothing upstream, and that the proxy survives a restart of the service.
Standard library only.
"""
import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from node_sets import bitstring, ids
from running_programs import BINARY, Program, ask, counters, free_port

IMMUTABLE = "public, max-age=31536000, immutable, no-transform"


class Interface(unittest.TestCase):
    bin = ""
    pack = None

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="meshfront-")
        packs = os.path.join(cls.folder, "packs")
        os.mkdir(packs)
        if cls.pack:
            shutil.copy(cls.pack, os.path.join(packs, "any name.pack"))
        else:
            for name, roots, depth in (("synthetic", "60", "9"), ("wide", "21000", "1")):
                subprocess.run([cls.program("write-synthetic-pack"),
                                os.path.join(packs, f"any {name}.pack"), name, "7", roots, depth],
                               check=True, stdout=subprocess.DEVNULL)
        with open(os.path.join(packs, "broken.pack"), "wb") as broken:
            broken.write(b"no pack" * 1000)
        cls.packs = packs
        cls.service = Program(cls.program("meshfront-serve"), "--packs", packs,
                              "--listen", "127.0.0.1:0")
        cls.proxy = Program(cls.program("meshfront-proxy"), "--upstream",
                            f"http://127.0.0.1:{cls.service.port}", "--listen", "127.0.0.1:0")
        cls.ports = [cls.service.port, cls.proxy.port]
        catalogue = json.loads(ask(cls.service.port, "/v1/meshes").body)
        cls.mesh = catalogue["meshes"][0]["name"]
        cls.revision = catalogue["meshes"][0]["revision"]
        cls.fixed = f"/v1/meshes/{cls.mesh}/{cls.revision}"
        cls.roots = cls.splittable([(tree, "") for tree in range(40)])
        cls.children = cls.splittable([(t, p + s) for t, p in cls.roots for s in "01"])

    @classmethod
    def tearDownClass(cls):
        statuses = [cls.proxy.stop(), cls.service.stop()]
        shutil.rmtree(cls.folder)
        if statuses != [0, 0]:
            raise AssertionError(f"the programs ended with {statuses}")

    @classmethod
    def program(cls, name):
        return os.path.join(cls.bin, name)

    @classmethod
    def splittable(cls, nodes):
        """Those that are no leaves, asked one by one."""
        return [node for node in nodes
                if ask(cls.service.port, f"{cls.fixed}/splits/{ids([node])}").status == 200]

    def start_proxy(self, *options):
        proxy = Program(self.program("meshfront-proxy"), "--upstream",
                        f"http://127.0.0.1:{self.service.port}", "--listen", "127.0.0.1:0",
                        *options)
        self.addCleanup(proxy.stop)
        return proxy

    def both(self, target, method="GET", body=None, headers=None):
        """The response, which both programs must give alike but for the proxy's own fields."""
        service, proxy = (ask(port, target, method, body, headers) for port in self.ports)
        self.assertEqual(service.status, proxy.status, target[:200])
        self.assertEqual("1.1 meshfront", proxy.headers.pop("via", None))
        self.assertNotIn("via", service.headers)
        self.assertNotIn("cache-status", service.headers)
        if "/splits" in target and service.status in (200, 304):
            self.assertRegex(proxy.headers.pop("cache-status", ""),
                             r"^meshfront; (hit|fwd=miss|fwd=partial)$")
        age = proxy.headers.pop("age", None)
        if service.status in (200, 304) and "no-store" != service.headers["cache-control"]:
            self.assertRegex(age or "", r"^\d+$")
        for response in (service, proxy):
            del response.headers["date"]
            if response.status != 204:
                self.assertIn("content-length", response.headers)
            self.assertEqual("*", response.headers["access-control-allow-origin"])
            self.assertNotIn("vary", response.headers)
            self.assertNotIn("set-cookie", response.headers)
        if service.status < 400:
            self.assertEqual(service.body, proxy.body)
            self.assertEqual(service.headers, proxy.headers)
        return service

    def assert_problem(self, status, target, method="GET", body=None, headers=None):
        response = self.both(target, method, body, headers)
        self.assertEqual(status, response.status, target[:200])
        self.assertEqual("application/problem+json", response.headers["content-type"])
        self.assertEqual("public, max-age=10" if status == 404 else "no-store",
                         response.headers["cache-control"])
        if method != "HEAD":
            problem = json.loads(response.body)
            self.assertEqual(status, problem["status"])
            self.assertTrue(problem["title"] and problem["detail"] and problem["type"])
            self.assertNotIn(self.folder, response.body.decode())
        return response

    # --- what exists --------------------------------------------------------------------------------

    def test_catalogue_and_metadata(self):
        catalogue = self.both("/v1/meshes")
        names = [mesh["name"] for mesh in json.loads(catalogue.body)["meshes"]]
        self.assertEqual([self.mesh] + ([] if self.pack else ["wide"]), names)  # not the broken one
        metadata = self.both(f"/v1/meshes/{self.mesh}")
        for response in (catalogue, metadata):
            self.assertEqual("application/json", response.headers["content-type"])
            self.assertEqual("public, max-age=10", response.headers["cache-control"])
            self.assertRegex(response.headers["etag"], r'^"[^"]+"$')
        links = json.loads(metadata.body)["links"]
        self.assertEqual(f"{self.fixed}/splits/{{ids}}{{?levels,significance}}", links["splits"])
        self.assertEqual(self.both(links["base"]).status, 200)

    def test_constants_are_immutable(self):
        metadata = json.loads(self.both(f"/v1/meshes/{self.mesh}").body)
        last = metadata["chunkCount"] - 1
        for resource in ("/base", "/chunks", "/chunks/0", f"/chunks/{last}"):
            response = self.both(self.fixed + resource)
            self.assertEqual(200, response.status)
            self.assertEqual(IMMUTABLE, response.headers["cache-control"])
            self.assertEqual(BINARY, response.headers["content-type"])
        self.assertEqual(metadata["baseBytes"], len(self.both(self.fixed + "/base").body))
        self.assert_problem(404, f"{self.fixed}/chunks/{last + 1}")

    def test_sets_by_get_and_query(self):
        for suffix in ("", "?levels=1", "?levels=3", "?significance=1", "?significance=0"):
            for nodes in (self.roots, self.roots[3:4], self.children, self.roots[:5]):
                target = f"{self.fixed}/splits/{ids(nodes)}{suffix}"
                got = self.both(target)
                self.assertEqual(200, got.status, got.body)
                self.assertEqual(IMMUTABLE, got.headers["cache-control"])
                asked = self.both(f"{self.fixed}/splits{suffix}", "QUERY", bitstring(nodes),
                                  {"Content-Type": BINARY})
                self.assertEqual(got.body, asked.body)
                self.assertEqual(target, asked.headers["content-location"])
                self.assertEqual(got.headers["etag"], asked.headers["etag"])

    def test_large_sets_go_by_query_alone(self):
        if self.pack:
            self.skipTest("needs the synthetic mesh with many roots")
        wide = next(m for m in json.loads(self.both("/v1/meshes").body)["meshes"]
                    if m["name"] == "wide")
        nodes = [(tree, "") for tree in range(5, 21000)]
        target = f"/v1/meshes/wide/{wide['revision']}/splits"
        self.assertGreater(len(target + ids(nodes)), 8000)
        self.assert_problem(414, f"{target}/{ids(nodes)}")
        answer = self.both(target, "QUERY", bitstring(nodes), {"Content-Type": BINARY})
        self.assertEqual(200, answer.status, answer.body[:200])
        self.assertNotIn("content-location", answer.headers)

    def test_head_and_conditional_requests(self):
        targets = ["/v1/meshes", f"/v1/meshes/{self.mesh}", self.fixed + "/base",
                   self.fixed + "/chunks", self.fixed + "/chunks/1",
                   f"{self.fixed}/splits/{ids(self.roots)}"]
        for target in targets:
            whole = self.both(target)
            head = self.both(target, "HEAD")
            self.assertEqual(whole.headers, head.headers)
            self.assertEqual(b"", head.body)
            tag = whole.headers["etag"]
            for condition in (tag, f'"other", {tag}', f"W/{tag}", "*"):
                for method in ("GET", "HEAD"):
                    unchanged = self.both(target, method, None, {"If-None-Match": condition})
                    self.assertEqual(304, unchanged.status, condition)
                    self.assertEqual(tag, unchanged.headers["etag"])
                    self.assertEqual(b"", unchanged.body)
                    self.assertEqual(whole.headers["content-length"],
                                     unchanged.headers["content-length"])
            self.assertEqual(200, self.both(target, "GET", None,
                                            {"If-None-Match": '"other"'}).status)

    def test_options_and_cors(self):
        response = self.both(f"{self.fixed}/splits", "OPTIONS")
        self.assertEqual(204, response.status)
        self.assertEqual("QUERY, OPTIONS", response.headers["access-control-allow-methods"])
        self.assertEqual(204, self.both("*", "OPTIONS").status)

    def test_health_and_counters(self):
        for port in self.ports:
            self.assertEqual(b"ok\n", ask(port, "/healthz").body)
            self.assertEqual(200, ask(port, "/readyz").status)
            page = ask(port, "/metrics")
            self.assertEqual("no-store", page.headers["cache-control"])
            self.assertIn("meshfront_records_total", page.body.decode())

    # --- what is refused ----------------------------------------------------------------------------

    def test_one_spelling_of_a_set(self):
        good = ids(self.roots)
        bits = bitstring(self.roots)
        padded = base64.urlsafe_b64encode(bits + b"\0").rstrip(b"=").decode()
        two = bitstring([(t, "") for t in (5, 6)])
        for wrong in (good + "=", good + "A", padded, good[:-1], "%41" + good[1:], "",
                      good.translate(str.maketrans("-_", "+/")) + "+",
                      base64.urlsafe_b64encode(two[:1]).rstrip(b"=").decode()):
            self.assert_problem(400, f"{self.fixed}/splits/{wrong}")
        for wrong in ("?", "?levels=0", "?levels=01", "?levels=", "?levels=x", "?levels=64",
                      "?levels=1&levels=1", "?levels=1&significance=1", "?significance=01",
                      "?significance=99", "?other=1", "?levels=1&other=1", "?levels=%31"):
            self.assert_problem(400, f"{self.fixed}/splits/{good}{wrong}")
        self.assert_problem(400, f"{self.fixed}/chunks/00")
        self.assert_problem(400, f"{self.fixed}/base?x=1")
        self.assert_problem(400, f"{self.fixed}/splits", "QUERY", bits + b"\0",
                            {"Content-Type": BINARY})
        self.assert_problem(400, f"{self.fixed}/splits", "QUERY", b"", {"Content-Type": BINARY})

    def test_what_does_not_exist(self):
        for target in ("/", "/v1", "/v1/meshes/", "/v1/meshes/none", "/v1/meshes/../x",
                       f"/v1/meshes/{self.mesh}/{'0' * 32}/base",
                       f"/v1/meshes/{self.mesh}/{'0' * 32}/splits/{ids(self.roots)}",
                       f"/v1/meshes/none/{self.revision}/base", f"{self.fixed}/chunks/4000000000",
                       f"{self.fixed}/splits/{ids([(4000000, '')])}",
                       f"{self.fixed}/splits/{ids([(self.roots[0][0], '0' * 63)])}"):
            self.assert_problem(404, target)

    def test_long_urls_and_large_content(self):
        self.assert_problem(414, f"{self.fixed}/splits/{'A' * 8000}")
        self.assert_problem(414, "/" + "a" * 50000)
        room = 8000 - len(self.fixed) - len("/splits/")
        self.assert_problem(400, f"{self.fixed}/splits/{'A' * room}")
        for size in ((1 << 20) + 1, 3 << 20):
            self.assert_problem(413, f"{self.fixed}/splits", "QUERY", b"\0" * size,
                                {"Content-Type": BINARY})
        self.assert_problem(400, f"{self.fixed}/splits", "QUERY", b"\0" * (1 << 20),
                            {"Content-Type": BINARY})

    def test_wrong_methods_and_types(self):
        for method in ("POST", "PUT", "DELETE", "PATCH", "QUERY"):
            response = self.assert_problem(405, f"{self.fixed}/base", method, b"")
            self.assertEqual("GET, HEAD, OPTIONS", response.headers["allow"])
        response = self.assert_problem(405, f"{self.fixed}/splits")
        self.assertEqual("QUERY, OPTIONS", response.headers["allow"])
        self.assert_problem(415, f"{self.fixed}/splits", "QUERY", bitstring(self.roots),
                            {"Content-Type": "text/plain"})

    # --- the proxy ----------------------------------------------------------------------------------

    def upstream_of(self, proxy):
        counted = counters(proxy.port)
        return (counted.get('meshfront_upstream_requests_total{kind="splits"}', 0),
                counted["meshfront_upstream_record_bytes_total"])

    def test_second_request_costs_nothing_upstream(self):
        proxy = self.start_proxy()
        targets = [f"{self.fixed}/splits/{ids(self.roots)}",
                   f"{self.fixed}/splits/{ids(self.children)}",
                   f"{self.fixed}/splits/{ids(self.roots[:4])}?levels=3"]
        first = [ask(proxy.port, target).body for target in targets]
        upstream = self.upstream_of(proxy)
        self.assertEqual(3, upstream[0])  # one for each
        self.assertEqual(first, [ask(proxy.port, target).body for target in targets])
        # Neither do other requests for the same records.
        for nodes in (self.roots[::2], self.children[1::2]):
            self.assertEqual(200, ask(proxy.port, f"{self.fixed}/splits/{ids(nodes)}").status)
        self.assertEqual(upstream, self.upstream_of(proxy))
        hits = counters(proxy.port)["meshfront_cache_record_hits_total"]
        self.assertGreater(hits, len(self.roots) + len(self.children))

    def test_a_miss_of_many_is_fetched_once(self):
        proxy = self.start_proxy()
        target = f"{self.fixed}/splits/{ids(self.roots)}?levels=3"
        bodies = []
        threads = [threading.Thread(target=lambda: bodies.append(ask(proxy.port, target).body))
                   for _ in range(16)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(1, len(set(bodies)))
        self.assertEqual(16, len(bodies))
        self.assertEqual(1, self.upstream_of(proxy)[0])

    def test_small_caches_answer_alike(self):
        proxy = self.start_proxy("--cache-size", "64KiB")
        for _ in range(2):
            for suffix in ("", "?levels=4", "?significance=2"):
                target = f"{self.fixed}/splits/{ids(self.roots)}{suffix}"
                self.assertEqual(ask(self.service.port, target).body, ask(proxy.port, target).body)
        self.assertLess(counters(proxy.port)["meshfront_cache_bytes"], 64 * 1024)

    def test_restart_of_the_service(self):
        address = f"127.0.0.1:{free_port()}"
        command = (self.program("meshfront-serve"), "--packs", self.packs, "--listen", address)
        service = Program(*command)
        proxy = Program(self.program("meshfront-proxy"), "--upstream", f"http://{address}",
                        "--listen", "127.0.0.1:0", "--patience", "20")
        self.addCleanup(proxy.stop)
        known = f"{self.fixed}/splits/{ids(self.roots)}"
        new = f"{self.fixed}/splits/{ids(self.children)}"
        first = ask(proxy.port, known).body
        self.assertEqual(0, service.stop())
        self.assertEqual(first, ask(proxy.port, known).body)  # cached, the service away
        waiting = []
        thread = threading.Thread(target=lambda: waiting.append(ask(proxy.port, new)))
        thread.start()
        time.sleep(0.5)
        service = Program(*command)
        self.addCleanup(service.stop)
        thread.join()
        self.assertEqual(200, waiting[0].status)
        self.assertEqual(ask(service.port, new).body, waiting[0].body)

    def test_an_absent_service(self):
        proxy = Program(self.program("meshfront-proxy"),
                        "--upstream", f"http://127.0.0.1:{free_port()}",
                        "--listen", "127.0.0.1:0", "--patience", "0.2")
        self.addCleanup(proxy.stop)
        response = ask(proxy.port, f"{self.fixed}/base")
        self.assertEqual(502, response.status)
        self.assertEqual("application/problem+json", response.headers["content-type"])
        self.assertEqual("no-store", response.headers["cache-control"])
        self.assertEqual(200, ask(proxy.port, "/healthz").status)
        self.assertEqual(503, ask(proxy.port, "/readyz").status)

    def test_a_proxy_over_a_proxy(self):
        second = Program(self.program("meshfront-proxy"), "--upstream",
                         f"http://127.0.0.1:{self.proxy.port}", "--listen", "127.0.0.1:0")
        self.addCleanup(second.stop)
        for resource in ("/base", "/chunks/0", f"/splits/{ids(self.children)}?levels=2"):
            self.assertEqual(ask(self.service.port, self.fixed + resource).body,
                             ask(second.port, self.fixed + resource).body)

    # --- the programs -------------------------------------------------------------------------------

    def test_wrong_usage(self):
        for command in (["meshfront-serve"], ["meshfront-serve", "--packs", "x", "--other"],
                        ["meshfront-serve", "--packs", "x", "--listen", "nowhere"],
                        ["meshfront-proxy"], ["meshfront-proxy", "--upstream", "ftp://x"],
                        ["meshfront-proxy", "--upstream", "http://x", "--cache-size", "much"]):
            done = subprocess.run([self.program(command[0]), *command[1:]], capture_output=True)
            self.assertEqual(2, done.returncode, command)
            self.assertNotEqual(b"", done.stderr + done.stdout)
        for program in ("meshfront-serve", "meshfront-proxy"):
            done = subprocess.run([self.program(program), "--help"], capture_output=True)
            self.assertEqual(0, done.returncode)
            self.assertIn(b"--listen", done.stdout)
        done = subprocess.run([self.program("meshfront-serve"), "--packs",
                               os.path.join(self.folder, "none")], capture_output=True)
        self.assertEqual(1, done.returncode)


if __name__ == "__main__":
    Interface.bin = sys.argv[1]
    Interface.pack = sys.argv[2] if len(sys.argv) > 2 else None
    unittest.main(argv=sys.argv[:1], verbosity=2)
