"""Random requests with the answers that they must get: valid ones to the octet, invalid ones with
their status as problem+json. Each draws from the generator of numbers that it is given.
"""
import base64
import json

import other_tests  # noqa: F401

from node_sets import bitstring

BINARY = ("Content-Type", "application/octet-stream")
LONGEST_URL = 8000
MOST_CONTENT = 1 << 20


class Wrong(Exception):
    """An answer is not what it must be."""


class Ask:
    """A request, and what must come."""

    def __init__(self, kind, method, target, status, body=None, fields=(), content=None, etag=None):
        self.kind, self.method, self.target, self.status, self.body = kind, method, target, status, body
        self.fields, self.content, self.etag = list(fields), content, etag

    def __str__(self):
        size = "" if self.content is None else f" with {len(self.content)} octets"
        fields = "".join(f" {name}: {value};" for name, value in self.fields)
        return f"{self.kind}: {self.method} {self.target[:300]}{fields}{size}"

    def check(self, answer):
        if answer.status != self.status:
            raise Wrong(f"status {answer.status} instead of {self.status}: {answer.body[:200]!r}")
        if self.status >= 400 and self.method != "HEAD":
            self.check_problem(answer)
        if self.status == 200 and self.method == "HEAD":
            if int(answer.fields.get("content-length", -1)) != len(self.body):
                raise Wrong(f"a length of {answer.fields.get('content-length')} instead of {len(self.body)}")
        elif self.body is not None and answer.body != self.body:
            raise Wrong(f"{len(answer.body)} octets that differ from the right {len(self.body)}")
        if self.status in (200, 304) and not answer.fields.get("etag", "").startswith('"'):
            raise Wrong("no strong entity tag")
        if self.etag and answer.fields["etag"] != self.etag:
            raise Wrong(f"entity tag {answer.fields['etag']} instead of {self.etag}")

    def check_problem(self, answer):
        if answer.fields.get("content-type") != "application/problem+json":
            raise Wrong(f"no problem but {answer.fields.get('content-type')}")
        if json.loads(answer.body)["status"] != self.status:
            raise Wrong(f"a problem that says {answer.body[:200]!r}")


def name_of(octets):
    return base64.urlsafe_b64encode(octets).rstrip(b"=").decode()


def random_set(mesh, chance):
    """(bitstring, parameter, answer)"""
    nodes = mesh.front(chance, int(2 ** chance.uniform(0, 9)))
    parameter, levels, significance = "", 0, None
    drawn = chance.random()
    if drawn < 0.25:
        levels = chance.choice((1, 1, 2, 3, 5, 63)) if len(nodes) < 30 else 1
        parameter = f"?levels={levels}"
    elif drawn < 0.5:
        significance = chance.randint(0, mesh.max_level if len(nodes) < 30 else mesh.max_level // 2)
        parameter = f"?significance={significance}"
    return bitstring(nodes), parameter, mesh.answer(nodes, levels, significance)


def records(mesh, chance, method):
    octets, parameter, body = random_set(mesh, chance)
    target = f"{mesh.fixed}/splits/{name_of(octets)}{parameter}"
    if method == "QUERY" or len(target) > LONGEST_URL:
        return Ask("query", "QUERY", f"{mesh.fixed}/splits{parameter}", 200, body, [BINARY], octets)
    return Ask("records", method, target, 200, body)


def valid(mesh, chance):
    """One request."""
    method = chance.choice(("GET", "GET", "GET", "HEAD", "QUERY"))
    if method == "QUERY" or chance.random() < 0.6:
        return records(mesh, chance, method)
    target = chance.choice(list(mesh.bodies))
    return Ask("resource", method, target, 200, mesh.bodies[target])


def repeated(ask, etag, chance):
    """The same request under a condition, given the entity tag of its answer."""
    conditions = {etag: 304, "*": 304, f'"other", {etag}': 304, f"W/{etag}": 304, '"other"': 200}
    condition, status = chance.choice(list(conditions.items()))
    body = ask.body if status == 200 else None
    return Ask("conditional", ask.method, ask.target, status, body,
               [*ask.fields, ("If-None-Match", condition)], ask.content, etag)


def full_tree(depth):
    visits = "00"
    for _ in range(depth):
        visits = "11" + visits + visits
    bits = "0001001" + "1" + visits  # one tree, the first
    bits += "0" * (-len(bits) % 8)
    return int(bits, 2).to_bytes(len(bits) // 8, "big")


TOO_MANY_NODES = full_tree(19)


def damaged(octets):
    """A set's bits cut short, and with more behind them: sets tell their own end."""
    return octets[:-1], octets + b"\0", octets + b"\x2a\xff"


def wrong_spelling(mesh, chance):
    octets = bitstring(mesh.front(chance, chance.randint(1, 40)))
    good = name_of(octets)
    wrong = chance.choice((good + "=", good + "+", good + ".", good[:-1] + "%41", "~", "",
                           *map(name_of, damaged(octets))))
    return Ask("wrong spelling", "GET", f"{mesh.fixed}/splits/{wrong}", 400)


def wrong_parameter(mesh, chance):
    good = name_of(bitstring(mesh.front(chance, 3)))
    wrong = chance.choice(("?", "?levels=0", "?levels=01", "?levels=", "?levels=64", "?levels=-1", "?levels=1&levels=1",
                           "?significance=99", "?significance=01", "?levels=1&significance=1", "?other=1",
                           "?levels=%31", f"?levels={'9' * 40}"))
    return Ask("wrong parameter", "GET", f"{mesh.fixed}/splits/{good}{wrong}", 400)


def missing(mesh, chance):
    revision = "".join(chance.choices("0123456789abcdef", k=32))
    target = chance.choice((
        "/", "/v1", "/v1/meshes/", "/v2/meshes", f"{mesh.path}x", f"{mesh.path}/{revision}/base", f"{mesh.fixed}/bas",
        f"{mesh.path}/{revision}/splits/mA", f"{mesh.fixed}/chunks/{mesh.chunk_count + chance.randint(0, 9)}",
        f"{mesh.fixed}/splits/{name_of(bitstring([(mesh.trees + chance.randint(0, 99999), '')]))}",
        f"{mesh.fixed}/splits/{name_of(bitstring([(mesh.nodes[0][0], '01' * 31)]))}"))
    return Ask("missing", chance.choice(("GET", "GET", "HEAD")), target, 404)


def wrong_content(mesh, chance):
    target = f"{mesh.fixed}/splits"
    content = bitstring(mesh.front(chance, chance.randint(1, 400)))
    kind, status, content, fields = chance.choice((
        ("damaged content", 400, chance.choice(damaged(content)), [BINARY]),
        ("endless content", 400, b"\xff" * chance.randint(1, 9999), [BINARY]), ("no content", 400, b"", [BINARY]),
        ("content of another type", 415, content, [("Content-Type", "text/plain")]),
        ("content without a type", 415, content, []),
        ("too much content", 413, bytes(MOST_CONTENT + chance.randint(1, 2 << 20)), [BINARY]),
        ("too many nodes", 413, TOO_MANY_NODES, [BINARY])))
    return Ask(kind, "QUERY", target, status, None, fields, content)


def long_url(mesh, chance):
    return Ask("long URL", "GET", f"{mesh.fixed}/splits/{'A' * chance.choice((8000, 9000, 20000))}", 414)


def wrong_method(mesh, chance):
    method = chance.choice(("POST", "PUT", "DELETE", "PATCH", "QUERY", "BREW"))
    return Ask("wrong method", method, chance.choice(list(mesh.bodies)), 405, None, [], b"")


INVALID = (wrong_spelling, wrong_parameter, missing, wrong_content, long_url, wrong_method)


def invalid(mesh, chance):
    return chance.choice(INVALID)(mesh, chance)
