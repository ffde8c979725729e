"""HTTP/1.1 over a plain socket, one request and answer at a time or several ahead.

Answers are read strictly: a status line, fields, as many octets as Content-Length says.
"""
import socket
import struct

ADDRESS = "127.0.0.1"


class WrongHttp(Exception):
    """What came is no answer."""


class Closed(Exception):
    """The other side closed between two answers."""


class Answer:
    def __init__(self, status, fields, body):
        self.status, self.fields, self.body = status, fields, body


class Connection:
    def __init__(self, port, timeout=60, receive_buffer=0):
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.settimeout(timeout)
        self.socket.connect((ADDRESS, port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.rest = b""

    def send(self, octets):
        self.socket.sendall(octets)

    def close(self):
        self.socket.close()

    def reset(self):
        """Closes with RST, whatever was still to come."""
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.socket.close()

    def more(self):
        block = self.socket.recv(1 << 16)
        self.rest += block
        return len(block) > 0

    def read(self, has_body=True):
        """The next answer; interim ones (1xx) are passed over."""
        while b"\r\n\r\n" not in self.rest:
            if len(self.rest) > 1 << 16:
                raise WrongHttp("a header without an end")
            if not self.more():
                if self.rest:
                    raise WrongHttp(f"closed within a header: {self.rest[:80]!r}")
                raise Closed
        header, self.rest = self.rest.split(b"\r\n\r\n", 1)
        first, *lines = header.decode("latin-1").split("\r\n")
        parts = first.split(" ", 2)
        if len(parts) < 2 or parts[0] not in ("HTTP/1.1", "HTTP/1.0") or not parts[1].isdigit():
            raise WrongHttp(f"no status line: {first[:80]!r}")
        status = int(parts[1])
        if status < 200:
            return self.read(has_body)
        fields = {}
        for line in lines:
            name, colon, value = line.partition(":")
            if not colon or name.lower() in fields:
                raise WrongHttp(f"a wrong or repeated field: {line[:80]!r}")
            fields[name.lower()] = value.strip()
        length = int(fields.get("content-length", 0))
        if not has_body or status in (204, 304):
            length = 0
        while len(self.rest) < length:
            if not self.more():
                raise WrongHttp(f"closed after {len(self.rest)} of {length} octets")
        body, self.rest = self.rest[:length], self.rest[length:]
        return Answer(status, fields, body)


def request(method, target, fields=(), content=None):
    lines = [f"{method} {target} HTTP/1.1", "Host: soak", *(f"{name}: {value}" for name, value in fields)]
    if content is not None:
        lines.append(f"Content-Length: {len(content)}")
    return "\r\n".join(lines).encode("latin-1") + b"\r\n\r\n" + (content or b"")
