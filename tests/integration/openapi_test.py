#!/usr/bin/env python3
"""shared/http/openapi.yaml, held against the running programs.

    openapi_test.py BIN_FOLDER

Each status of each operation is provoked - from the service and through a proxy, or from one in the
trouble that it means - and its fields, content type and content are compared with the file. What
the file does not list must not be answered.
"""
import http.client
import json
import os
import re
import resource
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import openapi_file
from node_sets import bitstring, ids
from running_programs import BINARY, Program, Response, ask, counters, free_port

WAITING_PLACES = 4096  # requests that may wait in a proxy for a thread


class Trouble:
    """A proxy, the service behind it unwell."""

    def __init__(self, interface, *options, upstream):
        self.proxy = Program(interface.program("meshfront-proxy"), "--listen", "127.0.0.1:0",
                             "--upstream", f"http://127.0.0.1:{upstream}", *options)
        self.port = self.proxy.port

    def stop(self):
        self.proxy.process.kill()  # what waits in it would hold it up
        self.proxy.process.wait()
        self.proxy.process.stdout.close()


class Description(unittest.TestCase):
    bin = ""

    @classmethod
    def setUpClass(cls):
        cls.document = openapi_file.load()
        cls.folder = tempfile.mkdtemp(prefix="meshfront-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        packs, damaged = (os.path.join(cls.folder, name) for name in ("packs", "damaged"))
        os.mkdir(packs)
        os.mkdir(damaged)
        pack = os.path.join(packs, "any.pack")
        subprocess.run([cls.program("write-synthetic-pack"), pack, "synthetic", "7", "60", "6"],
                       check=True, stdout=subprocess.DEVNULL)
        with open(pack, "rb") as whole, open(os.path.join(damaged, "any.pack"), "wb") as broken:
            broken.write(whole.read().replace(b"MFC\x02", b"MFC\xff"))  # no chunk is one any more
        cls.service = cls.serve(packs)
        cls.damaged = cls.serve(damaged)
        cls.proxy = Program(cls.program("meshfront-proxy"), "--upstream",
                            f"http://127.0.0.1:{cls.service.port}", "--listen", "127.0.0.1:0")
        cls.metadata = json.loads(ask(cls.service.port, "/v1/meshes/synthetic").body)
        roots = [(tree, "") for tree in range(40)]
        fixed = f"/v1/meshes/synthetic/{cls.metadata['revision']}"
        cls.nodes = [node for node in roots
                     if ask(cls.service.port, f"{fixed}/splits/{ids([node])}").status == 200]
        cls.parameters = {"mesh": "synthetic", "revision": cls.metadata["revision"],
                          "ids": ids(cls.nodes), "n": "0"}

    @classmethod
    def tearDownClass(cls):
        statuses = [program.stop() for program in (cls.proxy, cls.service, cls.damaged)]
        if statuses != [0, 0, 0]:
            raise AssertionError(f"the programs ended with {statuses}")

    @classmethod
    def program(cls, name):
        return os.path.join(cls.bin, name)

    @classmethod
    def serve(cls, packs):
        return Program(cls.program("meshfront-serve"), "--packs", packs, "--listen", "127.0.0.1:0")

    def target(self, path, **parameters):
        return path.format(**{**self.parameters, **parameters})

    def request(self, path, method, **parameters):
        """One that is answered by 200, or 204: target, method, content, fields."""
        query = method == "QUERY"
        return (self.target(path, **parameters), method,
                bitstring(self.nodes) if query else None, {"Content-Type": BINARY} if query else {})

    def requests(self, path, method, status):
        """Those that provoke the status from programs that are well. None for the others."""
        target, _, content, fields = good = self.request(path, method)
        with_query = "/splits" in path
        if status in ("200", "204"):
            suffixes = ("", "?levels=1", "?levels=63", "?significance=0",
                        f"?significance={self.metadata['maxLevel']}")
            return [(target + suffix, *good[1:])
                    for suffix in (suffixes if with_query and status == "200" else ("",))]
        if status == "304":
            tag = ask(self.service.port, *good).headers["etag"]
            return [(target, method, content, {**fields, "If-None-Match": tag})]
        if status == "400":
            wrong = [target + ("?levels=0" if with_query else "?x=1")]
            if with_query:
                wrong += [target + suffix for suffix in
                          ("?levels=64", "?significance=32", "?levels=01", "?levels=1&levels=1")]
            wrong += [self.target(path, ids=ids(self.nodes) + "=")] if "{ids}" in path else []
            wrong += [self.target(path, n="00")] if "{n}" in path else []
            requests = [(url, method, content, fields) for url in wrong]
            return requests + ([(target, method, b"\xff", fields)] if method == "QUERY" else [])
        if status == "404":
            absent = [self.target(path, mesh="none")]
            absent += [self.target(path, revision="0" * 32)] if "{revision}" in path else []
            absent += [self.target(path, n="4000000000")] if "{n}" in path else []
            absent += [self.target(path, ids=ids([(70, "")]))] if "{ids}" in path else []
            requests = [(url, method, content, fields) for url in absent]
            return requests + ([(target, method, bitstring([(70, "")]), fields)]
                               if method == "QUERY" else [])
        if status == "413":
            return [(target, method, b"\0" * ((1 << 20) + 1), fields)]
        if status == "414":
            return [(target + "?" + "a" * 8000, *good[1:])]
        if status == "415":
            return [(target, method, content, {"Content-Type": "text/plain"})]
        return None

    def assert_as_documented(self, response, path, method, status):
        documented = self.document["paths"][path][method.lower()]["responses"][status]
        self.assertEqual(int(status), response.status, f"{method} {path}")
        found = openapi_file.violations(response, documented, method != "HEAD")
        self.assertEqual([], found, f"{method} {path} {status}")

    def provoke(self, status, port, paths=None):
        """From a program that answers so whatever it is asked for."""
        count = 0
        for path, method, operation in openapi_file.operations(self.document):
            if status in operation["responses"] and (paths is None or path in paths):
                self.assert_as_documented(ask(port, *self.request(path, method)), path, method,
                                          status)
                count += 1
        self.assertGreater(count, 0)
        return count

    # --- each status --------------------------------------------------------------------------------

    def test_the_document_itself(self):
        self.assertEqual([], openapi_file.contradictions(self.document))

    def test_programs_that_are_well(self):
        left = set()
        for path, method, operation in openapi_file.operations(self.document):
            for status in operation["responses"]:
                requests = self.requests(path, method, status)
                if requests is None:
                    left.add(status)
                    continue
                for request in requests:
                    for program in (self.service, self.proxy):
                        self.assert_as_documented(ask(program.port, *request), path, method, status)
        # Each of these has a test below.
        self.assertEqual({"500", "502", "503", "504"}, left)

    def test_500_of_a_damaged_pack(self):
        self.provoke("500", self.damaged.port)

    def test_502_and_503_without_an_upstream(self):
        trouble = Trouble(self, "--patience", "0", upstream=free_port())
        self.addCleanup(trouble.stop)
        self.provoke("502", trouble.port)
        self.provoke("503", trouble.port, ["/readyz"])

    def test_504_behind_one_that_is_silent(self):
        silent = socket.create_server(("127.0.0.1", 0), backlog=1000)
        self.addCleanup(silent.close)
        trouble = Trouble(self, "--timeout", "0.2", "--patience", "0",
                          upstream=silent.getsockname()[1])
        self.addCleanup(trouble.stop)
        self.provoke("504", trouble.port)

    def test_503_of_a_proxy_with_too_much_to_wait_for(self):
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
        self.addCleanup(resource.setrlimit, resource.RLIMIT_NOFILE, (soft, hard))
        silent = socket.create_server(("127.0.0.1", 0), backlog=1000)
        self.addCleanup(silent.close)
        trouble = Trouble(self, "--waiting-threads", "1", "--timeout", "3600",
                          upstream=silent.getsockname()[1])
        self.addCleanup(trouble.stop)
        target = self.target("/v1/meshes/{mesh}/{revision}/base")
        waiting = []
        for _ in range(WAITING_PLACES + 1):  # one of them has the thread
            waiting.append(socket.create_connection(("127.0.0.1", trouble.port)))
            self.addCleanup(waiting[-1].close)
            waiting[-1].sendall(f"GET {target} HTTP/1.1\r\nHost: x\r\n\r\n".encode())
        give_up = time.monotonic() + 60
        while (counters(trouble.port).get('meshfront_requests_total{route="base",status="503"}', 0)
               == 0 and time.monotonic() < give_up):
            thread = threading.Thread(target=lambda: ask(trouble.port, target), daemon=True)
            thread.start()  # is answered only once all places are taken
            thread.join(1)
        self.provoke("503", trouble.port,
                     [path for path in self.document["paths"] if path.startswith("/v1/")])

    def assert_refused(self, name, status, program, octets):
        """By the server, whatever was asked for."""
        with socket.create_connection(("127.0.0.1", program.port), timeout=60) as connection:
            connection.sendall(octets)
            raw = http.client.HTTPResponse(connection)
            raw.begin()
            response = Response(raw)
        self.assertEqual(status, response.status)
        documented = self.document["components"]["responses"][name]
        self.assertEqual([], openapi_file.violations(response, documented, True), name)

    def test_refusals_of_any_request(self):
        begun = b"GET /healthz HTTP/1.1\r\nHost: x\r\n"
        for program in (self.service, self.proxy):
            for name, status, octets in (
                    ("BadRequest", 400, begun + b"A : b\r\n\r\n"),
                    ("UriTooLong", 414, b"GET /" + b"a" * 70000),
                    ("FieldsTooLarge", 431, begun + b"A: " + b"b" * 40000),
                    ("CodingUnknown", 501, begun + b"Transfer-Encoding: gzip\r\n\r\n"),
                    ("VersionUnknown", 505, b"GET /healthz HTTP/2.0\r\n\r\n")):
                self.assert_refused(name, status, program, octets)
        packs = os.path.join(self.folder, "packs")
        for name, status, octets, option in (
                ("RequestTimeout", 408, begun, ("--header-timeout", "0.2")),
                ("TooManyConnections", 429, begun + b"\r\n",
                 ("--max-connections-per-address", "1")),
                ("Busy", 503, begun + b"\r\n", ("--max-connections", "1"))):
            program = Program(self.program("meshfront-serve"), "--packs", packs, "--listen",
                              "127.0.0.1:0", *option)
            self.addCleanup(program.stop)
            with socket.create_connection(("127.0.0.1", program.port)) as first:
                first.sendall(begun + b"\r\n")
                self.assertIn(b" 200 ", first.recv(1 << 16))
                self.assert_refused(name, status, program, octets)

    # --- nothing else -------------------------------------------------------------------------------

    def test_methods(self):
        refused = self.document["components"]["responses"]["MethodNotAllowed"]
        for path, item in self.document["paths"].items():
            listed = {method.upper() for method in openapi_file.METHODS if method in item}
            allow = ask(self.service.port, self.target(path), "OPTIONS").headers["allow"]
            self.assertEqual(listed, set(allow.split(", ")), path)
            for method in ("GET", "HEAD", "QUERY", "POST", "PUT", "PATCH", "DELETE", "PROPFIND"):
                if method in listed:
                    continue
                for program in (self.service, self.proxy):
                    response = ask(program.port, self.target(path), method, b"")
                    self.assertEqual(405, response.status, f"{method} {path}")
                    self.assertEqual(allow, response.headers["allow"])
                    self.assertEqual([], openapi_file.violations(response, refused,
                                                                 method != "HEAD"))

    def test_routes(self):
        """Those that the code knows, by the names that the counters have, and those linked to."""
        with open(os.path.join(openapi_file.ROOT, "shared", "http", "route.cpp"),
                  encoding="utf-8") as source:
            names = re.search(r"routeName\(.*?\n}", source.read(), re.DOTALL).group()
        known = set(re.findall(r'return "([a-z-]+)"', names)) - {"server", "unknown"}
        self.assertGreater(len(known), 8)
        routes = {item["x-route"]: path for path, item in self.document["paths"].items()}
        self.assertEqual(known, set(routes))
        self.assertEqual(len(routes), len(self.document["paths"]))
        for name, path in routes.items():
            label = f'meshfront_requests_total{{route="{name}",status="204"}}'
            before = counters(self.service.port).get(label, 0)
            ask(self.service.port, self.target(path), "OPTIONS")
            self.assertEqual(before + 1, counters(self.service.port)[label])
        for link in self.metadata["links"].values():
            link = re.sub(r"\{\?.*\}", "", link).replace("{ids}", "x").replace("{n}", "0")
            matches = [path for path in self.document["paths"]
                       if re.fullmatch(re.sub(r"\{\w+\}", "[^/]+", path), link)]
            self.assertEqual(1, len(matches), link)
        for absent in ("/", "/v1", "/v1/", "/v1/meshes/", "/v2/meshes", "/openapi.yaml",
                       f"/v1/meshes/synthetic/{self.metadata['revision']}",
                       f"/v1/meshes/synthetic/{self.metadata['revision']}/records"):
            self.assertEqual(404, ask(self.service.port, absent).status, absent)

    def test_statuses_that_were_counted(self):
        """After the others (tests go by name): no status that the file does not list."""
        routes = {item["x-route"]: item for item in self.document["paths"].values()}
        for program in (self.service, self.proxy, self.damaged):
            for name in counters(program.port):
                match = re.fullmatch(r'meshfront_requests_total\{route="(.*)",status="(\d+)"\}', name)
                if not match or match.group(1) in ("server", "unknown") or match.group(2) == "405":
                    continue
                listed = {status for method in openapi_file.METHODS if method in routes[match.group(1)]
                          for status in routes[match.group(1)][method]["responses"]}
                self.assertIn(match.group(2), listed, name)


if __name__ == "__main__":
    Description.bin = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
