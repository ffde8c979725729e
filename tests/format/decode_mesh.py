"""Decodes a whole mesh from a running service: a second decoder, written from shared/codec/README.md
alone, in another language than the first, with none of its code.

    python3 decode_mesh.py URL OUTPUT.ply [SEED]

URL is that of the mesh, http://HOST:PORT/v1/meshes/NAME. With a SEED the splits are applied in a
random order, else as they stand in the chunks. It is made to be read, not to be fast.
"""

import heapq
import json
import math
import random
import sys
import urllib.request

from cut_code import Frame, find_cut
from wire_bits import Damaged
from wire_records import Base, read_chunk

NORMAL_BITS = 14


# --- positions -------------------------------------------------------------------------------------


def divided(p, q):
    """To nearest, halves away from zero."""
    if q < 0:
        p, q = -p, -q
    result = (abs(p) + q // 2) // q
    return result if p >= 0 else -result


def main_axis(n):
    return max(range(3), key=lambda i: (abs(n[i]), -i))


def shortened(w):
    """With components below 2^30, and the bits dropped."""
    shift = max(0, max(abs(x) for x in w).bit_length() - 30)
    return [(abs(x) >> shift) * (1 if x >= 0 else -1) for x in w], shift


def normal_below(n, d):
    square = sum(x * x for x in d)
    if square == 0:
        return n
    dot = sum(x * y for x, y in zip(n, d))
    w, shift = shortened([x * square - y * dot for x, y in zip(n, d)])
    length = math.isqrt(sum(x * x for x in w))
    if length == 0 or 5 * length < square << NORMAL_BITS >> shift:
        return n
    return tuple(divided(x << NORMAL_BITS, length) for x in w)


def root_normals(positions, triangles):
    sums = [[0, 0, 0] for _ in positions]
    for triangle in triangles:
        if max(triangle) >= len(positions):
            continue
        p0, p1, p2 = (positions[v] for v in triangle)
        a = [x - y for x, y in zip(p1, p0)]
        b = [x - y for x, y in zip(p2, p0)]
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            cross = a[j] * b[k] - a[k] * b[j]
            half = abs(cross) // 2 * (1 if cross >= 0 else -1)
            for v in triangle:
                sums[v][i] = max(-(1 << 61), min(1 << 61, sums[v][i] + half))
    normals = []
    for w in sums:
        w, _ = shortened(w)
        length = math.isqrt(sum(x * x for x in w))
        normals.append(tuple(divided(x << NORMAL_BITS, length) for x in w) if length
                       else (0, 0, 1 << NORMAL_BITS))
    return normals


def in_range(old, delta, limit):
    new = tuple(x + y for x, y in zip(old, delta))
    if not all(0 <= x < limit for x in new):
        raise Damaged("a colour or normal out of range")
    return new


# --- the mesh --------------------------------------------------------------------------------------


def after(h):
    return h - 2 if h % 3 == 2 else h + 1


def before(h):
    return h + 2 if h % 3 == 0 else h - 1


class Mesh:
    """Half-edge 3 f + i runs from corner i of face f to the next one. Corners are places of vertices:
    a split leaves u in the place of s and gives t a new one."""

    def __init__(self, base):
        self.tables = base.tables
        self.limit = 1 << base.grid_bits
        self.positions = list(base.positions) + [None] * base.virtuals
        self.colours = list(base.colours) + [None] * base.virtuals
        self.vertex_normals = list(base.normals) + [None] * base.virtuals
        self.nodes = [(tree, "") for tree in range(len(self.positions))]
        normals = root_normals(base.positions, base.triangles)
        self.normals = normals + [None] * base.virtuals
        self.node_positions = dict(zip(self.nodes, self.positions))  # of split ones too
        self.places = {node: place for place, node in enumerate(self.nodes)}
        self.corners = [v for triangle in base.triangles for v in triangle]
        self.keys = [(-1, "", index) for index in range(len(base.triangles))]
        self.twins, self.outgoing = [None] * len(self.corners), {}
        by_ends = {}
        for h, v in enumerate(self.corners):
            by_ends[v, self.corners[after(h)]] = h
            self.outgoing[v] = h
        for (x, y), h in by_ends.items():
            self.twins[h] = by_ends[y, x]

    def glue(self, one, other):
        self.twins[one], self.twins[other] = other, one

    def ring(self, place):
        first = h = self.outgoing[place]
        ring = []
        while True:
            ring.append(h)
            h = self.twins[before(h)]
            if h == first:
                return ring

    def split(self, node, record):
        u = self.places.pop(node)
        ring = self.ring(u)
        ends = [self.corners[after(h)] for h in ring]
        t = len(self.nodes)
        frame = self.place_child(node, record, u)
        left, right, l_first = find_cut([self.nodes[v] for v in ends],
                                        [self.keys[h // 3] for h in ring], record.cut,
                                        self.tables.chances, frame, self.node_positions.get)
        moved = (left - right) % len(ring)
        if left == right and l_first:
            moved = len(ring)
        for i in range(moved):
            self.corners[ring[(right + i) % len(ring)]] = t

        ut = len(self.corners)
        tl, lu, ur, rt, tu = range(ut + 1, ut + 6)
        self.corners += [u, t, ends[left], u, ends[right], t]
        self.twins += [None] * 6
        tree, path = node
        self.keys += [(tree, path, 0), (tree, path, 1)]
        l_out, r_out = ring[left], ring[right]
        l_in, r_in = self.twins[l_out], self.twins[r_out]
        self.glue(ut, tu)
        if left != right:
            self.glue(lu, l_out)
            self.glue(tl, l_in)
            self.glue(rt, r_out)
            self.glue(ur, r_in)
        elif l_first:
            self.glue(tl, l_in)
            self.glue(rt, l_out)
            self.glue(lu, ur)
        else:
            self.glue(lu, l_out)
            self.glue(ur, l_in)
            self.glue(tl, rt)
        self.outgoing[u], self.outgoing[t] = ut, tu

    def place_child(self, node, record, u):
        n = self.normals[u]
        a = main_axis(n)
        b, c = (a + 1) % 3, (a + 2) % 3
        d = [0, 0, 0]
        d[b], d[c] = record.b, record.c
        d[a] = divided(-(n[b] * d[b] + n[c] * d[c]), n[a]) + record.residual
        position = tuple(x + y for x, y in zip(self.positions[u], d))
        if not all(0 <= x < self.limit for x in position):
            raise Damaged("a vertex outside the grid")
        tree, path = node
        below = normal_below(n, d)
        self.normals[u] = below
        self.normals.append(below)
        self.positions.append(position)
        self.nodes[u] = (tree, path + "0")
        self.nodes.append((tree, path + "1"))
        self.places[self.nodes[u]] = u
        self.places[self.nodes[-1]] = len(self.nodes) - 1
        self.node_positions[self.nodes[u]] = self.positions[u]
        self.node_positions[self.nodes[-1]] = position
        self.colours.append(in_range(self.colours[u], record.colour, 256))
        self.vertex_normals.append(in_range(self.vertex_normals[u], record.normal,
                                            1 << self.tables.normal_bits))
        return Frame(self.positions[u], d, n)

    def drawn(self):
        triangles = zip(self.corners[::3], self.corners[1::3], self.corners[2::3])
        return [t for t in triangles if all(self.positions[v] is not None for v in t)]


# --- a whole mesh ----------------------------------------------------------------------------------


def fetch(url):
    with urllib.request.urlopen(url, timeout=60) as response:
        return response.read()


def refine(mesh, records, seed):
    """Applies all records: parents first, and beyond that in preorder or in any order."""
    chance = random.Random(seed)
    ready = []

    def offer(node):
        if node in records:
            heapq.heappush(ready, (node if seed is None else chance.random(), node))

    for node in list(mesh.places):
        offer(node)
    applied = 0
    while ready:
        _, (tree, path) = heapq.heappop(ready)
        mesh.split((tree, path), records[tree, path])
        applied += 1
        offer((tree, path + "0"))
        offer((tree, path + "1"))
    return applied


def write_ply(path, mesh, grid):
    origin, step = grid["origin"], grid["step"]
    triangles = mesh.drawn()
    used = sorted({v for t in triangles for v in t})
    number = {v: i for i, v in enumerate(used)}
    with open(path, "w", encoding="ascii") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(used)}\nproperty double x\n"
                   "property double y\nproperty double z\n")
        if mesh.tables.normal_bits:
            file.write("property float nx\nproperty float ny\nproperty float nz\n")
        if mesh.tables.colours:
            file.write("".join(f"property uchar {c}\n" for c in ("red", "green", "blue", "alpha")))
        file.write(f"element face {len(triangles)}\n"
                   "property list uchar int vertex_indices\nend_header\n")
        for v in used:
            numbers = [o + step * x for o, x in zip(origin, mesh.positions[v])]
            if mesh.tables.normal_bits:
                numbers += direction(mesh.vertex_normals[v], mesh.tables.normal_bits)
            if mesh.tables.colours:
                numbers += mesh.colours[v]
            file.write(" ".join(repr(x) for x in numbers) + "\n")
        for t in triangles:
            file.write("3 " + " ".join(str(number[v]) for v in t) + "\n")


def direction(folded, bits):
    """The unit vector of an octahedral normal."""
    x, y = (2 * k / ((1 << bits) - 1) - 1 for k in folded)
    z = 1 - abs(x) - abs(y)
    if z < 0:
        x, y = (math.copysign(1 - abs(y), x), math.copysign(1 - abs(x), y))
    length = math.sqrt(x * x + y * y + z * z)
    return [x / length, y / length, z / length]


def main(url, output, seed=None):
    metadata = json.loads(fetch(url))
    content = f"{url}/{metadata['revision']}"
    base = Base(fetch(f"{content}/base"))
    records = {}
    for number in range(metadata["chunkCount"]):
        records.update(read_chunk(fetch(f"{content}/chunks/{number}"), base.tables))
    mesh = Mesh(base)
    applied = refine(mesh, records, seed)
    if not applied == len(records) == base.splits:
        raise Damaged(f"{applied} of {len(records)} records applied; the mesh has {base.splits}")
    write_ply(output, mesh, metadata["quantization"])
    print(f"decoded {applied} records, {len(mesh.drawn())} triangles")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(*sys.argv[1:])
