"""What no honest client sends. Each does its worst to a server and tells what it was answered: a
status, None where the connection was closed or left without an answer. ALLOWED says which are right.
"""
import contextlib
import time

from soak_client import Closed, Connection, WrongHttp, request
from soak_requests import BINARY, TOO_MANY_NODES, Wrong, valid

PATIENCE = 5  # seconds: for an answer that need not come


def answered(connection, has_body=True):
    try:
        return connection.read(has_body).status
    except (Closed, WrongHttp, OSError):
        return None


def sent(connection, octets):
    with contextlib.suppress(OSError):  # the server need not listen to the end
        connection.send(octets)


def tell(port, octets, finish=True):
    """Sends all of it; unless the request is finished, nothing can be answered for sure."""
    connection = Connection(port, timeout=PATIENCE if finish else 0.2)
    try:
        sent(connection, octets)
        return answered(connection)
    finally:
        connection.reset()


def garbage(mesh, port, chance):
    octets = chance.randbytes(chance.randint(1, 4000))
    return tell(port, octets + b"\r\n\r\n", finish=False)


def half_a_request(mesh, port, chance):
    ask = valid(mesh, chance)
    whole = request(ask.method, ask.target, ask.fields, ask.content)
    connection = Connection(port)
    connection.send(whole[:chance.randint(1, len(whole) - 1)])
    chance.choice((connection.close, connection.reset))()


def slow_sender(mesh, port, chance):
    """A request in small pieces, which is answered all the same, or given up on the way."""
    ask = valid(mesh, chance)
    whole = request(ask.method, ask.target, ask.fields, ask.content)
    connection = Connection(port)
    try:
        until = chance.choice((len(whole), chance.randint(1, len(whole))))
        pieces = chance.randint(2, 12)
        for i in range(pieces):
            connection.send(whole[until * i // pieces:until * (i + 1) // pieces])
            time.sleep(chance.random() / 10)
        if until < len(whole):
            return None
        ask.check(connection.read(ask.method != "HEAD"))
        return ask.status
    finally:
        connection.reset()


def pipelining(mesh, port, chance):
    """Many requests ahead of the answers: these come in order, each right."""
    asks = [valid(mesh, chance) for _ in range(chance.randint(2, 25))]
    connection = Connection(port)
    try:
        connection.send(b"".join(request(a.method, a.target, a.fields, a.content) for a in asks))
        for ask in asks:
            ask.check(connection.read(ask.method != "HEAD"))
    except (Closed, OSError) as problem:
        raise Wrong(f"pipelined answers break off: {problem!r}") from problem
    finally:
        connection.reset()
    return 200


def many_fields(mesh, port, chance):
    count, size = chance.choice(((5000, 5), (40, 3000), (1, 90000), (60000, 1)))
    fields = "".join(f"X-{i}: {'v' * size}\r\n" for i in range(count))
    return tell(port, f"GET {mesh.path} HTTP/1.1\r\nHost: x\r\n{fields}\r\n".encode())


def reset_in_mid_answer(mesh, port, chance):
    connection = Connection(port, receive_buffer=4096)
    target = f"{mesh.fixed}/splits/mA?significance={mesh.max_level}"
    connection.send(request("GET", target) * chance.randint(1, 8))
    if chance.random() < 0.7:
        connection.more()
    connection.reset()


def contradictory_length(mesh, port, chance):
    """Two readings of where the content ends: none may be taken."""
    lengths = chance.choice((
        "Content-Length: 4\r\nContent-Length: 5", "Content-Length: -1", "Content-Length: 4x",
        "Content-Length: 99999999999999999999999", "Content-Length: 4\r\nTransfer-Encoding: chunked",
        "Content-Length: 4, 5", "Content-Length: +4", "Content-Length: 0x4", "Transfer-Encoding: gzip",
        "Transfer-Encoding: chunked, identity", "Transfer-Encoding: chunked\r\nContent-Length: 4"))
    head = f"QUERY {mesh.fixed}/splits HTTP/1.1\r\nHost: x\r\n{BINARY[0]}: {BINARY[1]}\r\n{lengths}\r\n\r\n"
    return tell(port, head.encode() + b"4\r\n\x98\x98\x98\x98\r\n0\r\n\r\n")


def endless_chunks(mesh, port, chance):
    """Content in pieces without an end, or of impossible sizes."""
    head = (f"QUERY {mesh.fixed}/splits HTTP/1.1\r\nHost: x\r\n{BINARY[0]}: {BINARY[1]}\r\n"
            "Transfer-Encoding: chunked\r\n\r\n")
    size = chance.choice((b"10000", b"100000", b"ffffffffffffffffff", b"-1", b"zz", b"1"))
    piece = size + b"\r\n" + bytes(min(int(size, 16), 1 << 20) if size.isdigit() else 100) + b"\r\n"
    connection = Connection(port, timeout=0.5 if size == b"1" else PATIENCE)
    try:
        sent(connection, head.encode() + piece * max(1, (3 << 20) // len(piece) if size != b"1" else 1000))
        return answered(connection)
    finally:
        connection.reset()


def odd_request(mesh, port, chance):
    path = mesh.path
    line = chance.choice((
        f"GET {path}", f"GET {path} HTTP/9.9", f"GET  {path} HTTP/1.1", f"get {path} HTTP/1.1",
        f"GET\t{path}\tHTTP/1.1", f"GET {path}\x00 HTTP/1.1", f"GET {path} HTTP/1.1\r\n folded: x", f"GET {path} HTTP/1.1\r\nno colon",
        f"GET {path} HTTP/1.1\r\nA b: c", f"GET {path} HTTP/1.1\r\n: empty", "GET /../../../etc/passwd HTTP/1.1",
        f"GET {path}%00 HTTP/1.1", "GET /v1/meshes/..%2f..%2fetc HTTP/1.1", f"{'G' * 9000} {path} HTTP/1.1",
        "* * HTTP/1.1", "CONNECT a:80 HTTP/1.1", "PRI * HTTP/2.0", "TRACE / HTTP/1.1"))
    return tell(port, line.encode() + b"\r\nHost: x\r\n\r\n", finish=False)


def unread_content(mesh, port, chance):
    """Content where none belongs, with a request hidden in it that nobody may answer."""
    hidden = request("GET", "/healthz")
    connection = Connection(port, timeout=PATIENCE)
    try:
        sent(connection, request("GET", mesh.path, [], hidden) + request("GET", mesh.path + "x"))
        first, second = answered(connection), answered(connection)
        if second not in (404, None):
            raise Wrong(f"what stood in the content is answered with {second}")
        return first
    finally:
        connection.reset()


def many_nodes(mesh, port, chance):
    """Large contents over one connection, never read."""
    connection = Connection(port, receive_buffer=4096)
    whole = request("QUERY", f"{mesh.fixed}/splits", [BINARY], TOO_MANY_NODES)
    connection.socket.settimeout(0.5)
    sent(connection, whole * chance.randint(1, 5))
    connection.reset()


REFUSED = {400, 404, 405, 408, 411, 413, 414, 417, 431, 501, 505, None}
ALLOWED = {
    garbage: REFUSED, half_a_request: {None}, slow_sender: {200, None}, pipelining: {200},
    many_fields: {400, 413, 414, 431, None}, reset_in_mid_answer: {None},
    contradictory_length: {400, 413, 501, None}, endless_chunks: {400, 413, None},
    odd_request: REFUSED | {200}, unread_content: {200, 400, 413, None}, many_nodes: {None},
}


def hostile(mesh, port, chance):
    """(what was done, the answer's status)"""
    attack = chance.choice(list(ALLOWED))
    name = attack.__name__.replace("_", " ")
    try:
        status = attack(mesh, port, chance)
    except (Wrong, WrongHttp, Closed, OSError, ValueError, KeyError) as problem:
        raise Wrong(f"{name}: {problem!r}") from problem
    if status not in ALLOWED[attack]:
        raise Wrong(f"{name} is answered with {status}")
    return name, status


def idle_storm(port, chance, count, seconds):
    """`count` connections that say nothing or little, kept and then dropped at once."""
    connections = []
    try:
        for _ in range(count):
            connections.append(Connection(port))
            if chance.random() < 0.1:
                connections[-1].send(b"GET /v1/me")
        time.sleep(seconds)
    finally:
        for connection in connections:
            chance.choice((connection.close, connection.reset))()
