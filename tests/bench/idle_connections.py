#!/usr/bin/env python3
"""Prints what idle keep-alive connections cost a server: its memory before and with them.

  idle_connections.py BIN_FOLDER [--connections 10000] [--json]

Starts the service over a small pack, opens the connections, asks once over each, and leaves them
idle: resident octets (/proc/PID/statm) before and after, which leave out the kernel's buffers, and
processor time for ten idle seconds. Exit status 1 if a connection was refused or ended.
"""

import argparse
import json
import os
import pathlib
import resource
import select
import socket
import sys
import tempfile
import time

from served_programs import Server, run

IDLE_SECONDS = 10
REQUEST = b"GET /v1/meshes HTTP/1.1\r\nHost: localhost\r\nUser-Agent: idle\r\nAccept: */*\r\n\r\n"


def resident(pid):
    pages = int(pathlib.Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def processor_seconds(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def ask(connection):
    connection.sendall(REQUEST)
    if not connection.recv(1 << 16).startswith(b"HTTP/1.1 200"):
        sys.exit("a connection was refused")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path, metavar="BIN_FOLDER")
    parser.add_argument("--connections", type=int, default=10000)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    if hard < options.connections + 100:
        sys.exit(f"the system grants {hard} descriptors only")
    with tempfile.TemporaryDirectory() as packs:
        run(options.programs / "write-synthetic-pack", f"{packs}/a.pack", "mesh", "1", "60", "6")
        command = (options.programs / "meshfront-serve", "--packs", packs, "--listen", "127.0.0.1:0",
                   "--threads", "1", "--idle-timeout", "3600")
        with Server(*command) as server:
            address = ("127.0.0.1", int(server.url.rsplit(":", 1)[1]))
            pid = server.process.pid
            for _ in range(100):  # what is allocated once, whoever asks
                with socket.create_connection(address) as first:
                    ask(first)
            before = resident(pid)
            held = []
            for _ in range(options.connections):
                held.append(socket.create_connection(address))
                ask(held[-1])
            after, used = resident(pid), processor_seconds(pid)
            time.sleep(IDLE_SECONDS)
            used = processor_seconds(pid) - used
            poll = select.poll()
            for connection in held:
                poll.register(connection, select.POLLIN)
            if poll.poll(0):
                sys.exit("an idle connection has ended")
            for connection in held:
                connection.close()
    each = (after - before) / options.connections / 1024
    if options.json:
        print(json.dumps({"connections": options.connections, "before": before, "after": after,
                          "kib_each": each, "processor_seconds_idle": used}))
        return
    print(f"{options.connections} idle connections: {before / 2**20:.1f} MiB before, "
          f"{after / 2**20:.1f} MiB with them, {each:.2f} KiB each; "
          f"{used:.2f} s of processor in {IDLE_SECONDS} s")


if __name__ == "__main__":
    main()
