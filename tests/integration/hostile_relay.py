"""A relay that spoils the first answers of each kind on their way, then behaves.

    relay = HostileRelay(port_of_the_service, FAULTS["cut"], times=3)
    ... relay.port ...

A fault gets the relay's Exchange: the request, the service's right answer, and the socket to write
to. It either sends something itself, or says False: then there was nothing to spoil.
"""
import re
import socket
import socketserver
import threading
import time

from running_programs import ask

PAUSE = 0.05


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = CRC_TABLE[(crc ^ byte) & 255] ^ crc >> 8
    return crc ^ 0xFFFFFFFF


def crc_entry(value):
    for _ in range(8):
        value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
    return value


CRC_TABLE = [crc_entry(value) for value in range(256)]


def with_checksum(content):
    return content + crc32c(content).to_bytes(4, "little")


def kind_of(target):
    """mesh, base, chunks, chunk or splits; None for what is never spoilt."""
    path = target.split("?")[0]
    for kind, pattern in (("mesh", r"/v1/meshes/[^/]+"), ("base", r"/v1/meshes/.*/base"),
                          ("chunks", r"/v1/meshes/.*/chunks"), ("chunk", r"/v1/meshes/.*/\d+"),
                          ("splits", r"/v1/meshes/.*/splits(/.*)?")):
        if re.fullmatch(pattern, path):
            return kind
    return None


class Exchange:
    def __init__(self, relay, connection, method, target, body, headers):
        self.relay, self.connection = relay, connection
        self.method, self.target, self.body, self.headers = method, target, body, headers
        self.kind = kind_of(target)
        self.right = ask(relay.upstream, target, method, body, headers)

    def head(self, fields, response=None):
        response = response or self.right
        kept = {name: value for name, value in response.headers.items()
                if name not in ("content-length", "connection", "date", "transfer-encoding")}
        kept.update(fields)
        lines = [f"HTTP/1.1 {response.status} Whatever"]
        lines += [f"{name}: {value}" for name, value in kept.items() if value is not None]
        return ("\r\n".join(lines) + "\r\n\r\n").encode()

    def send(self, data):
        self.connection.sendall(data)

    def send_whole(self, body, response=None, **fields):
        fields = {name.replace("_", "-"): value for name, value in fields.items()}
        self.send(self.head({"content-length": len(body), **fields}, response) + body)
        return True

    def end(self):
        self.connection.shutdown(socket.SHUT_RDWR)
        return True


# --- the faults ------------------------------------------------------------------------------------


def cut(exchange):
    body = exchange.right.body
    exchange.send(exchange.head({"content-length": len(body)}) + body[:len(body) // 2])
    return exchange.end()


def trickle(exchange):
    body = exchange.right.body
    exchange.send(exchange.head({"content-length": len(body)}))
    step = len(body) // 10 + 1
    for begin in range(0, len(body), step):
        exchange.send(body[begin:begin + step])
        time.sleep(PAUSE)
    return True


def silent(exchange):
    """Until the other side has had enough."""
    exchange.connection.settimeout(60)
    exchange.connection.recv(1)
    return exchange.end()


def wrong_bytes(exchange):
    body = bytearray(exchange.right.body)
    place = len(body) // 2
    # JSON stays JSON: one digit for another.
    digits = [i for i, byte in enumerate(body) if byte in b"12345678"]
    if exchange.kind == "mesh":
        body[digits[len(digits) // 2]] += 1
    else:
        body[place] ^= 0x10
    return exchange.send_whole(bytes(body))


def other_revision(exchange):
    """What an outdated replica would say that does not look at the revision."""
    relay = exchange.relay
    target = exchange.target.replace(relay.revision, relay.outdated_revision)
    other = ask(relay.outdated, target, exchange.method, exchange.body, exchange.headers)
    if other.status != 200 or exchange.kind == "mesh":
        return False
    return exchange.send_whole(other.body, other)


def other_request(exchange):
    """The answer to another request of the same kind, as from a cache that mixed them up."""
    other = exchange.relay.other_answer(exchange)
    return other is not None and exchange.send_whole(other.body, other)


def content_type(exchange):
    return exchange.send_whole(exchange.right.body, content_type="text/html; charset=utf-8")


def page(exchange):
    return exchange.send_whole(b"<!DOCTYPE html><html><body>Please log in.</body></html>\n",
                               content_type="text/html", etag=None, cache_control="max-age=3600")


def wrong_tag(exchange):
    tag = re.sub(r'[0-9a-f]{8}"$', lambda m: '"'.join([f"{int(m[0][:8], 16) ^ 1:08x}", ""]),
                 exchange.right.headers["etag"])
    return exchange.send_whole(exchange.right.body, etag=tag)


def too_short(exchange):
    body = exchange.right.body
    exchange.send(exchange.head({"content-length": len(body) + 100}) + body)
    return exchange.end()


def no_last_chunk(exchange):
    body = exchange.right.body
    part = body[:len(body) * 2 // 3]
    exchange.send(exchange.head({"transfer-encoding": "chunked"}) +
                  f"{len(part):x}\r\n".encode() + part + b"\r\n")
    return exchange.end()


def fewer_records(exchange):
    """Right length, right checksum, and yet not everything."""
    body = exchange.right.body
    return exchange.send_whole(with_checksum(body[:(len(body) - 4) * 2 // 3]))


def longer(exchange):
    body = exchange.right.body
    return exchange.send_whole(with_checksum(body[:-4] + b"\x5a" * 3000))


def endless(exchange):
    exchange.send(exchange.head({"transfer-encoding": "chunked"}))
    block = b"10000\r\n" + b"\0" * 65536 + b"\r\n"
    for _ in range(4000):
        exchange.send(block)
        time.sleep(0.01)
    return exchange.end()


# Of each, how many answers of a kind are spoilt.
FAULTS = {
    "cut in mid-answer": (cut, 3),
    "slow: trickling": (trickle, 3),
    "slow: silent": (silent, 1),
    "wrong: bytes": (wrong_bytes, 3),
    "wrong: revision": (other_revision, 3),
    "wrong: other nodes": (other_request, 3),
    "wrong: content type": (content_type, 3),
    "wrong: a page, 200": (page, 3),
    "wrong: ETag": (wrong_tag, 3),
    "truncated: length": (too_short, 3),
    "truncated: chunked": (no_last_chunk, 3),
    "truncated: checksum right": (fewer_records, 3),
    "oversized: longer": (longer, 3),
    "oversized: endless": (endless, 2),
}


# --- the relay -------------------------------------------------------------------------------------


class Connection(socketserver.StreamRequestHandler):
    def handle(self):
        try:
            while self.handle_one():
                pass
        except (OSError, ValueError):
            pass  # the other side has gone

    def handle_one(self):
        line = self.rfile.readline().decode()
        if not line:
            return False
        method, target, _ = line.split()
        headers = {}
        while (field := self.rfile.readline().decode().strip()):
            name, value = field.split(":", 1)
            headers[name.lower()] = value.strip()
        body = self.rfile.read(int(headers.get("content-length", 0))) or None
        passed = {name: headers[name] for name in ("if-none-match", "content-type", "via")
                  if name in headers}
        return self.server.relay.answer(
            Exchange(self.server.relay, self.connection, method, target, body, passed))


class Server(socketserver.ThreadingTCPServer):
    daemon_threads = True
    allow_reuse_address = True
    request_queue_size = 128


class HostileRelay:
    def __init__(self, upstream, fault, times, kinds=("mesh", "base", "chunks", "chunk", "splits")):
        self.upstream, self.fault, self.kinds = upstream, fault, kinds
        self.lock = threading.Lock()
        self.left = dict.fromkeys(kinds, times)
        self.spoilt = {}     # request -> time of its first fault, until a right answer went out
        self.mended = []     # seconds between these two
        self.touched = set()  # all requests that were spoilt
        self.seen = {}       # request -> its right answer
        self.revision = self.outdated = self.outdated_revision = None
        self.server = Server(("127.0.0.1", 0), Connection)
        self.server.relay = self
        self.port = self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, args=(0.05,), daemon=True).start()

    def other_answer(self, exchange):
        with self.lock:
            others = [answer for (_, target, _), answer in self.seen.items()
                      if kind_of(target) == exchange.kind and target != exchange.target]
        # The most alike is the hardest to tell.
        return min(others, key=lambda a: abs(len(a.body) - len(exchange.right.body)), default=None)

    def answer(self, exchange):
        request = (exchange.method, exchange.target, exchange.body)
        if exchange.right.status != 200 or exchange.kind not in self.kinds:
            return self.pass_on(exchange, request)
        with self.lock:
            spoil = self.left[exchange.kind] > 0
            self.left[exchange.kind] -= spoil
            if spoil:
                self.spoilt.setdefault(request, time.monotonic())
                self.touched.add(request)
        if spoil:
            try:
                done = self.fault(exchange)
            except OSError:
                return False  # the other side did not want the rest
            if done:
                with self.lock:
                    self.seen[request] = exchange.right
                return True
            with self.lock:
                self.left[exchange.kind] += 1
                self.touched.discard(request)
                self.spoilt.pop(request, None)
        with self.lock:
            self.seen[request] = exchange.right
        return self.pass_on(exchange, request)

    def pass_on(self, exchange, request):
        if exchange.right.status == 304:
            exchange.send(exchange.head({}))
        else:
            exchange.send_whole(exchange.right.body)
        with self.lock:
            begin = self.spoilt.pop(request, None)
            if begin is not None:
                self.mended.append(time.monotonic() - begin)
        return True

    def stop(self):
        self.server.shutdown()
        self.server.server_close()
