"""Seconds until a picture of 35 dB and until everything seen is there, for each way of getting a mesh."""

import csv
import http.server
import json
import re
import sys
import threading

from encoded_meshes import mesh_name
from links import link_to, port_of
from served_programs import Server, run

TARGET = 35  # dB
PICTURE = ("--headless", "--size", "500x500", "--camera", "whole")


class Timing(dict):
    """to_target and settled, in seconds; and what is told beside them."""


def view(programs, url, *options):
    done = run(programs / "meshfront-view", url, *PICTURE, "--json", *options)
    if done.returncode != 0:
        sys.exit(f"meshfront-view {url}: {done.stderr.strip()}")
    return json.loads(done.stdout)


class ReceiverDriven:
    """meshfront-view --live against meshfront-serve. Drawing for the PSNR takes time that has nothing to
    do with the link, so it is streamed twice: once to learn how many records 35 dB take over this link,
    once without looking at the picture, timed until that many are there."""

    label = "receiver-driven"

    def __init__(self, programs, packs, mesh, options=("--live",)):
        self.programs, self.packs, self.mesh, self.options = programs, packs, mesh, options

    def __enter__(self):
        self.server = Server(self.programs / "meshfront-serve", "--packs", self.packs, "--listen", "127.0.0.1:0")
        return self

    def __exit__(self, *error):
        self.server.__exit__(*error)

    def time(self, rtt, mbit):
        trace = self.packs / "trace.csv"
        with link_to(port_of(self.server.url), rtt, mbit) as port:
            url = f"http://127.0.0.1:{port}/v1/meshes/{mesh_name(self.mesh)}"
            seen = view(self.programs, url, *self.options, "--reference", self.mesh, "--until", f"psnr:{TARGET}")
            timed = view(self.programs, url, *self.options, "--trace", trace)
        target = seen["psnr_target"]
        with trace.open(newline="") as lines:
            reached = next(row for row in csv.DictReader(lines) if int(row["records"]) >= target["records"])
        return Timing(to_target=float(reached["seconds"]), settled=timed["seconds"], bytes=int(reached["bytes_down"]),
                      records=int(reached["records"]), requests=int(reached["requests"]))


class SenderDriven:
    """sender-driven-client against sender-driven-server, whose log tells when which octets were there. In
    the order that needs the fewest."""

    label = "sender-driven"

    def __init__(self, programs, pack, octets_to_target, options=()):
        self.programs, self.pack, self.octets_to_target, self.options = programs, pack, octets_to_target, options

    def __enter__(self):
        self.server = Server(self.programs / "sender-driven-server", self.pack, "--listen", "127.0.0.1:0",
                             "--order", "significance")
        return self

    def __exit__(self, *error):
        self.server.__exit__(*error)

    def time(self, rtt, mbit):
        log = self.pack.with_suffix(".csv")
        with link_to(port_of(self.server.url), rtt, mbit) as port:
            done = run(self.programs / "sender-driven-client", f"127.0.0.1:{port}", "--camera", "whole", "--size", "500x500",
                       "--log", log, *self.options)
        if done.returncode != 0:
            sys.exit(f"sender-driven-client: {done.stderr.strip()}")
        with log.open(newline="") as lines:
            rows = list(csv.DictReader(lines))
        reached = next((row for row in rows if int(row["bytes"]) >= self.octets_to_target), rows[-1])
        return Timing(to_target=float(reached["seconds"]), settled=float(rows[-1]["seconds"]), bytes=int(reached["bytes"]),
                      records=int(reached["records"]))


class CameraFirst(SenderDriven):
    """The same with the camera told before there is a mesh to look at: a round trip less."""

    label = "sender-driven, camera first"

    def __init__(self, *arguments):
        super().__init__(*arguments, options=("--camera-first",))


class FileServer:
    """A folder's files over HTTP, as from any web server."""

    def __init__(self, folder):
        class Handler(http.server.SimpleHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def __init__(self, *arguments):
                super().__init__(*arguments, directory=str(folder))

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.port = self.server.server_port
        self.thread = threading.Thread(target=self.server.serve_forever, daemon=True)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.server.server_close()


def download(port, name):
    done = run("curl", "-sf", "--output", "/dev/null", "--write-out", "%{time_total}", f"http://127.0.0.1:{port}/{name}")
    if done.returncode != 0:
        sys.exit(f"curl: cannot download {name}")
    return float(done.stdout)


class Files:
    """A way that downloads files of a folder."""

    def __init__(self, folder):
        self.files = FileServer(folder)

    def __enter__(self):
        self.files.__enter__()
        return self

    def __exit__(self, *error):
        self.files.__exit__(*error)


class Pipe(Files):
    """Splits in one order for everybody are a file that is read from its beginning: timed are files of as
    many octets as 35 dB and the whole mesh take. Decoding, which would take place meanwhile, is free."""

    label = "view-independent"

    def __init__(self, folder, octets_to_target, octets):
        super().__init__(folder)
        self.octets_to_target = octets_to_target
        (folder / "part.bin").write_bytes(bytes(octets_to_target))
        (folder / "whole.bin").write_bytes(bytes(octets))

    def time(self, rtt, mbit):
        with link_to(self.files.port, rtt, mbit) as port:
            return Timing(to_target=download(port, "part.bin"), settled=download(port, "whole.bin"), bytes=self.octets_to_target)


class Draco(Files):
    """The whole file at the same quantisation, then its decoding, which nothing is seen of before."""

    label = "Draco's file"

    def __init__(self, folder, plain_mesh, bits):
        super().__init__(folder)
        file = folder / "mesh.drc"
        encoded = run("draco_encoder", "-i", plain_mesh, "-o", file, "-qp", bits, "-cl", 10)
        decoded = run("draco_decoder", "-i", file, "-o", folder / "decoded.ply")
        told = re.search(r"\((\d+) ms to decode\)", decoded.stdout)
        if encoded.returncode != 0 or not told:
            sys.exit(f"Draco: {encoded.stderr.strip()} {decoded.stdout.strip()}")
        self.decoding = int(told.group(1)) / 1e3
        self.octets = file.stat().st_size

    def time(self, rtt, mbit):
        with link_to(self.files.port, rtt, mbit) as port:
            seconds = download(port, "mesh.drc") + self.decoding
        return Timing(to_target=seconds, settled=seconds, bytes=self.octets)
