#!/usr/bin/env python3
"""What deploy/ ships for operators besides caches, held against the programs and the system.

    operation_files_test.py BIN_FOLDER

The units are accepted by systemd, start programs that take the options they give, and are exposed
no more than said; the dashboard asks Prometheus for nothing that /metrics does not have.
"""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

from running_programs import Program, ask

DEPLOY = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "deploy")
PROGRAMS = ("meshfront-serve", "meshfront-proxy")
MOST_EXPOSED = 15  # what `systemd-analyze security` calls 1.5, of 10


class OperationFiles(unittest.TestCase):
    bin = ""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="meshfront-")
        self.addCleanup(shutil.rmtree, self.folder)

    def program(self, name):
        return os.path.join(self.bin, name)

    def unit(self, name):
        """The unit's path, the program where it was built."""
        with open(os.path.join(DEPLOY, "systemd", f"{name}.service"), encoding="utf-8") as file:
            text = file.read()
        self.assertEqual(1, text.count(f"ExecStart=/usr/local/bin/{name} "))
        path = os.path.join(self.folder, f"{name}.service")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace("/usr/local/bin/", os.path.abspath(self.bin) + "/"))
        return path

    def metrics(self):
        """Names and types of what both programs show."""
        packs = os.path.join(self.folder, "packs")
        os.mkdir(packs)
        service = Program(self.program("meshfront-serve"), "--packs", packs, "--listen",
                          "127.0.0.1:0")
        self.addCleanup(service.stop)
        proxy = Program(self.program("meshfront-proxy"), "--upstream",
                        f"http://127.0.0.1:{service.port}", "--listen", "127.0.0.1:0")
        self.addCleanup(proxy.stop)
        return {name: kind for program in (service, proxy) for name, kind in
                re.findall(r"^# TYPE (\S+) (\S+)$", ask(program.port, "/metrics").body.decode(),
                           re.MULTILINE)}

    def test_units(self):
        for name in PROGRAMS:
            path = self.unit(name)
            for command in (["verify", "--man=no"],
                            ["security", "--offline=yes", f"--threshold={MOST_EXPOSED}"]):
                done = subprocess.run(["systemd-analyze", *command, path], capture_output=True,
                                      text=True)
                self.assertEqual(0, done.returncode, done.stdout + done.stderr)
                if command[0] == "verify":
                    self.assertEqual("", done.stderr)

    def test_options_that_units_give(self):
        for name in PROGRAMS:
            with open(self.unit(name), encoding="utf-8") as file:
                text = file.read()
            start = shlex.split(re.search("^ExecStart=(.*)$", text, re.MULTILINE).group(1))
            examples = shlex.split(" ".join(re.findall("^#   MESHFRONT_OPTIONS=(.*)$", text,
                                                       re.MULTILINE)))
            used = [word for word in start[1:] + examples if word.startswith("--")]
            self.assertGreater(len(used), 2)
            help_text = subprocess.run([self.program(name), "--help"], capture_output=True,
                                       text=True, check=True).stdout
            for option in used:
                self.assertRegex(help_text, rf"(?m)^ +{option} ")

    def test_dashboard(self):
        with open(os.path.join(DEPLOY, "grafana", "meshfront.json"), encoding="utf-8") as file:
            dashboard = json.load(file)
        queries = [target["expr"] for panel in dashboard["panels"]
                   for target in panel.get("targets", [])]
        queries += [variable["query"]["query"] for variable in dashboard["templating"]["list"]
                    if variable["type"] == "query"]
        self.assertGreater(len(queries), 10)
        shown = self.metrics()
        for query in queries:
            self.assertEqual(query.count("("), query.count(")"), query)
            names = re.findall(r"meshfront_[a-z_]+", query)
            self.assertTrue(names, query)
            for name in names:
                family = re.sub("_(bucket|sum|count)$", "", name)
                kind = shown.get(name) or (shown.get(family) if family != name else None)
                self.assertIsNotNone(kind, f"{name} is not on /metrics")
                self.assertEqual(kind == "histogram", family != name, name)
                # Counters are only looked at by their rate, gauges never.
                rated = re.search(rf"rate\({name}\b", query) is not None
                if "label_values" not in query:
                    self.assertEqual(kind != "gauge", rated, query)
        self.assertEqual(len(dashboard["panels"]), len({p["id"] for p in dashboard["panels"]}))
        asked = " ".join(queries)
        for name in ("requests_in_flight", "in_flight_bytes", "connections_open", "refused_total",
                     "cut_total", "request_seconds", "record_bytes_total", "chunk_bytes_total",
                     "index_hits_total", "cache_record_hits_total", "cache_bytes",
                     "cache_evicted_bytes_total", "upstream_seconds", "upstream_in_flight"):
            self.assertIn(f"meshfront_{name}", asked)


if __name__ == "__main__":
    OperationFiles.bin = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
