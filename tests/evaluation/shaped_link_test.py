#!/usr/bin/env python3
"""The relay that stands for a link: its arithmetic exactly, and over real sockets what no machine's load
can change: nothing is faster than the link, and nothing is altered."""

import pathlib
import random
import socket
import subprocess
import sys
import threading
import time
import unittest

import link_probe
from shaped_link import FIRST_WINDOW, OneWay, Window

SCRIPT = pathlib.Path(__file__).with_name("shaped_link.py")


class Relay:
    def __init__(self, port, rtt, mbit):
        self.process = subprocess.Popen([sys.executable, SCRIPT, "--to", str(port), "--rtt", str(rtt), "--mbit", str(mbit)],
                                        stdout=subprocess.PIPE, text=True)
        self.port = int(self.process.stdout.readline().rsplit(":", 1)[1])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.status = self.process.wait(timeout=30)
        self.process.stdout.close()


class ArithmeticTest(unittest.TestCase):
    def test_octets_wait_for_those_before(self):
        way = OneWay(rate=1000, delay=0.1)
        self.assertAlmostEqual(way.arrival(0, 100), 0.2)
        self.assertAlmostEqual(way.arrival(0.05, 100), 0.3)  # leaves at 0.1
        self.assertAlmostEqual(way.arrival(5, 100), 5.2)  # the link was idle

    def test_window_doubles_each_round_trip(self):
        window, trips, left = Window(), 0, 15 * FIRST_WINDOW
        while left > 0:
            octets = min(window.room(), left)
            window.sent(octets)
            window.acknowledged(octets)
            left, trips = left - octets, trips + 1
        self.assertEqual(trips, 4)  # 1 + 2 + 4 + 8
        self.assertEqual(window.under_way, 0)


class RelayTest(unittest.TestCase):
    def test_is_no_faster_than_the_link(self):
        with link_probe.ProbeServer() as server, Relay(server.port, 60, 8) as relay:
            measured = link_probe.probe(relay.port, 50_000)
        self.assertGreaterEqual(measured["round_trip"], 0.058)
        self.assertGreaterEqual(measured["setup"], 0.118)  # handshake, then question and answer

    def test_a_server_that_speaks_first_is_heard_after_two_round_trips(self):
        with socket.create_server(("127.0.0.1", 0)) as listener, Relay(listener.getsockname()[1], 50, 8) as relay:
            def greet():
                connection, _ = listener.accept()
                with connection:
                    connection.sendall(b"!")

            thread = threading.Thread(target=greet, daemon=True)
            thread.start()
            begin = time.monotonic()
            with socket.create_connection(("127.0.0.1", relay.port), 30) as connection:
                self.assertEqual(connection.recv(1), b"!")
            self.assertGreaterEqual(time.monotonic() - begin, 0.098)
            thread.join()

    def test_bandwidth_is_shared(self):
        with link_probe.ProbeServer() as server, Relay(server.port, 2, 8) as relay:
            begin = time.monotonic()
            threads = [threading.Thread(target=self.fetch, args=(relay.port, 100_000)) for _ in range(3)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertGreaterEqual(time.monotonic() - begin, 0.29)  # 300 kB at 1 MB/s

    @staticmethod
    def fetch(port, octets):
        with socket.create_connection(("127.0.0.1", port), 30) as connection:
            link_probe.ask(connection, octets)

    def test_passes_on_what_comes_and_ends(self):
        data = random.Random(1).randbytes(300_000)
        received = bytearray()

        def echo(listener):
            connection, _ = listener.accept()
            with connection:
                while piece := connection.recv(1 << 16):
                    connection.sendall(piece)

        with socket.create_server(("127.0.0.1", 0)) as listener:
            thread = threading.Thread(target=echo, args=(listener,), daemon=True)
            thread.start()
            with Relay(listener.getsockname()[1], 4, 200) as relay:
                with socket.create_connection(("127.0.0.1", relay.port), 30) as connection:
                    sender = threading.Thread(target=lambda: (connection.sendall(data), connection.shutdown(socket.SHUT_WR)))
                    sender.start()
                    while piece := connection.recv(1 << 16):
                        received += piece
                    sender.join()
            thread.join(timeout=10)
        self.assertEqual(relay.status, 0)
        self.assertEqual(bytes(received), data)

    def test_a_server_that_is_away_closes_the_connection(self):
        with socket.create_server(("127.0.0.1", 0)) as listener:
            port = listener.getsockname()[1]
        with Relay(port, 1, 10) as relay, socket.create_connection(("127.0.0.1", relay.port), 30) as connection:
            connection.settimeout(30)
            self.assertEqual(connection.recv(1), b"")


if __name__ == "__main__":
    unittest.main()
