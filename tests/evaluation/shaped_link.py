#!/usr/bin/env python3
"""A TCP relay that behaves like a link of a given round trip and bandwidth, for where the kernel may
not be told to (tc with netem).

  shaped_link.py --to PORT --rtt MILLISECONDS --mbit RATE [--port PORT]

Prints "listening on http://127.0.0.1:PORT" when it is ready; ends on SIGTERM. All connections share the
link, which carries RATE megabits a second each way; every octet arrives half a round trip after it has
left. To set up a connection costs a round trip. A sender begins with a window of ten segments, which
grows by each octet that is acknowledged (RFC 5681's slow start, RFC 6928); nothing is lost, so it never
shrinks. Headers of TCP and IP, 3 % of full segments, are not counted.
"""

import argparse
import asyncio
import collections
import contextlib
import signal
import sys

SEGMENT = 1448  # octets, as over Ethernet
FIRST_WINDOW = 10 * SEGMENT
WIDEST_WINDOW = 4 << 20  # what a receiver's buffer lets through
PIECE_SECONDS = 0.002  # of the link, for one piece: what comes is passed on about so finely


class OneWay:
    """The link in one direction, in seconds of whatever clock the caller has."""

    def __init__(self, rate, delay):
        self.rate = rate  # octets a second
        self.delay = delay
        self.free_at = 0.0

    def arrival(self, now, octets):
        """When octets that are ready at `now` have arrived: behind all that came before."""
        self.free_at = max(now, self.free_at) + octets / self.rate
        return self.free_at + self.delay

    def piece(self):
        """Octets that are passed on together."""
        return int(min(max(self.rate * PIECE_SECONDS, SEGMENT), 16 * SEGMENT))


class Window:
    """What a sender may have under way: arithmetic alone."""

    def __init__(self):
        self.size = FIRST_WINDOW
        self.under_way = 0

    def room(self):
        return self.size - self.under_way

    def sent(self, octets):
        self.under_way += octets

    def acknowledged(self, octets):
        self.under_way -= octets
        self.size = min(self.size + octets, WIDEST_WINDOW)


class Stream:
    """One direction of one connection."""

    def __init__(self, way, round_trip, reader, writer):
        self.way, self.round_trip, self.reader, self.writer = way, round_trip, reader, writer
        self.loop = asyncio.get_running_loop()
        self.window = Window()
        self.opened = asyncio.Event()
        self.arriving = collections.deque()

    async def run(self, not_before):
        await until(self.loop, not_before)
        while True:
            while self.window.room() <= 0:
                self.opened.clear()
                await self.opened.wait()
            data = await self.reader.read(min(self.window.room(), self.way.piece()))
            now = self.loop.time()
            if not data:
                await until(self.loop, max(self.way.free_at, now) + self.way.delay)
                self.deliver_all()
                with contextlib.suppress(OSError):
                    self.writer.write_eof()
                return
            self.window.sent(len(data))
            self.arriving.append(data)
            arrival = self.way.arrival(now, len(data))
            self.loop.call_at(arrival, self.deliver)
            self.loop.call_at(arrival + self.round_trip / 2, self.acknowledge, len(data))

    def deliver(self):
        if self.arriving and not self.writer.is_closing():
            self.writer.write(self.arriving.popleft())

    def deliver_all(self):
        while self.arriving:
            data = self.arriving.popleft()
            if not self.writer.is_closing():
                self.writer.write(data)

    def acknowledge(self, octets):
        self.window.acknowledged(octets)
        self.opened.set()


async def until(loop, moment):
    await asyncio.sleep(max(0.0, moment - loop.time()))


class ShapedLink:
    def __init__(self, target_port, round_trip, rate):
        self.target_port, self.round_trip = target_port, round_trip
        self.up = OneWay(rate, round_trip / 2)
        self.down = OneWay(rate, round_trip / 2)

    async def serve(self, reader, writer):
        loop = asyncio.get_running_loop()
        begin = loop.time()  # the client's SYN leaves
        try:
            await until(loop, begin + self.round_trip)
            server_reader, server_writer = await asyncio.open_connection("127.0.0.1", self.target_port)
        except OSError:
            writer.close()
            return
        try:
            up = Stream(self.up, self.round_trip, reader, server_writer)
            down = Stream(self.down, self.round_trip, server_reader, writer)
            # The server sees the connection half a round trip after the client does: that is when its
            # own first octets leave.
            await asyncio.gather(up.run(begin + self.round_trip), down.run(begin + 1.5 * self.round_trip))
        except (OSError, asyncio.CancelledError):
            pass  # one side has gone, or the relay ends: so does the other
        finally:
            for side in (writer, server_writer):
                side.close()


async def relay(options):
    link = ShapedLink(options.to, options.rtt / 1e3, options.mbit * 1e6 / 8)
    server = await asyncio.start_server(link.serve, "127.0.0.1", options.port, backlog=256)
    ended = asyncio.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(number, ended.set)
    print(f"listening on http://127.0.0.1:{server.sockets[0].getsockname()[1]}", flush=True)
    await ended.wait()
    server.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--to", type=int, required=True, metavar="PORT", help="of the server, on this machine")
    parser.add_argument("--rtt", type=float, required=True, metavar="MS", help="round trip, milliseconds")
    parser.add_argument("--mbit", type=float, required=True, metavar="RATE", help="megabits a second, each way")
    parser.add_argument("--port", type=int, default=0, help="to listen on (default 0: a free one)")
    asyncio.run(relay(parser.parse_args()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
