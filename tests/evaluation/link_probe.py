"""What a link really does: its round trip and throughput, measured on connections of its own."""

import socket
import threading
import time

REPLY = b"!"


class ProbeServer:
    """Answers a number of octets, asked for as a line, with so many."""

    def __enter__(self):
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()
        return self

    def serve(self):
        while True:
            try:
                connection, _ = self.socket.accept()
            except OSError:
                return
            threading.Thread(target=self.answer, args=(connection,), daemon=True).start()

    @staticmethod
    def answer(connection):
        with connection, connection.makefile("rb") as lines:
            for line in lines:
                connection.sendall(REPLY * int(line))

    def __exit__(self, *_):
        self.socket.shutdown(socket.SHUT_RDWR)
        self.socket.close()
        self.thread.join()


def ask(connection, octets):
    """Seconds until the last one of so many octets is here."""
    begin = time.monotonic()
    connection.sendall(b"%d\n" % octets)
    while octets > 0:
        data = connection.recv(min(octets, 1 << 16))
        if not data:
            raise ConnectionError("the link has broken off")
        octets -= len(data)
    return time.monotonic() - begin


def probe(port, octets, rounds=3):
    """{setup: seconds until a new connection's first answer, round_trip: seconds, rate: octets a second of
    a window that has grown}; the best of some rounds, for other work may only make them worse."""
    begin = time.monotonic()
    with socket.create_connection(("127.0.0.1", port), 30) as connection:
        connection.settimeout(60)
        ask(connection, 1)
        setup = time.monotonic() - begin
        trips = [ask(connection, 1) for _ in range(rounds)]
        ask(connection, octets)  # opens the window
        long = min(ask(connection, 2 * octets) for _ in range(2))
        short = min(ask(connection, octets) for _ in range(2))
    return {"setup": setup, "round_trip": min(trips), "rate": octets / max(long - short, 1e-6)}
