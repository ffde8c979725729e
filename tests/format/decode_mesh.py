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

LEVELS = 32
RUNS_CODED = 6
NORMAL_BITS = 14


class Damaged(Exception):
    pass


# --- bits and numbers ------------------------------------------------------------------------------


class Bits:
    """Reads bits forward from a text of 0 and 1."""

    def __init__(self, digits, at=0):
        self.digits = digits
        self.at = at

    def u(self, count):
        if self.at + count > len(self.digits):
            raise Damaged("cut short")
        value = int(self.digits[self.at:self.at + count] or "0", 2)
        self.at += count
        return value

    def eg(self, order):
        zeros = 0
        while self.u(1) == 0:
            zeros += 1
            if zeros > 40:
                raise Damaged("a number beyond all limits")
        rest = zeros + order
        return (1 << rest) + self.u(rest) - (1 << order)

    def tb(self, n):
        k = n.bit_length() - 1
        short = (2 << k) - n
        value = self.u(k)
        return value if value < short else (value << 1 | self.u(1)) - short

    def zigzag(self, order):
        value = self.eg(order)
        return -(value + 1) // 2 if value & 1 else value // 2

    def end(self):
        rest = self.digits[self.at:]
        if len(rest) >= 8 or "1" in rest:
            raise Damaged("bits behind the end")


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0x82F63B78 if crc & 1 else crc >> 1
    return crc ^ 0xFFFFFFFF


def checked(data):
    content, stored = data[:-4], int.from_bytes(data[-4:], "little")
    if crc32c(content) != stored:
        raise Damaged("wrong checksum")
    return Bits("".join(f"{byte:08b}" for byte in content))


class Huffman:
    def __init__(self, bits, symbols):
        self.codes = {}  # digits -> symbol
        used = bits.eg(3)
        if used == 1:
            self.codes[""] = bits.eg(3)
            return
        lengths = []  # (length, symbol)
        symbol, last = -1, 4
        for _ in range(used):
            symbol += 1 + bits.eg(0)
            last += bits.zigzag(0)
            if symbol >= symbols or not 1 <= last <= 15:
                raise Damaged("a code beyond its symbols")
            lengths.append((last, symbol))
        code = before = 0
        for length, symbol in sorted(lengths):
            code <<= length - before
            self.codes[f"{code:0{length}b}"] = symbol
            code, before = code + 1, length
        if lengths and code != 1 << before:
            raise Damaged("a code that is not complete")

    def read(self, bits):
        for length in range(16):
            symbol = self.codes.get(bits.digits[bits.at:bits.at + length])
            if symbol is not None:
                bits.u(length)
                return symbol
        raise Damaged("no such code")


# --- base ------------------------------------------------------------------------------------------


class Tables:
    def __init__(self, bits):
        self.finest = bits.u(5)
        v = self.classes = bits.u(6)
        self.cut_lengths = []  # (leaf flags, length), numbered as header symbols are
        for flags in range(4):
            length = 0
            for _ in range(bits.u(5)):
                length += 1 + bits.eg(2)
                self.cut_lengths.append((flags, length))
        self.header = [Huffman(bits, len(self.cut_lengths)) for _ in range(4)]
        self.level = [Huffman(bits, LEVELS) for _ in range(4)]
        self.levels = [Huffman(bits, LEVELS * LEVELS) for _ in range(4)]
        self.joint = [Huffman(bits, v * v) for _ in range(4)]
        self.residual = [Huffman(bits, v + 4) for _ in range(64)]
        self.cyclic, self.linear = {}, {}
        for runs in range(2, RUNS_CODED + 1):
            self.cyclic[runs] = Huffman(bits, runs * runs + runs)
            self.linear[runs, False] = Huffman(bits, runs * runs)
            self.linear[runs, True] = Huffman(bits, runs * runs)


def base_triangles(bits, vertices):
    triangles, seen = [], set()
    queue, open_edges = [], {}  # an ordered set: insertion order is age

    def add(triangle):
        triangles.append(triangle)
        seen.update(triangle)
        for i in range(3):
            x, y = triangle[i], triangle[(i + 1) % 3]
            if (y, x) in open_edges:
                del open_edges[y, x]
            else:
                open_edges[x, y] = True
                queue.append((x, y))

    for _ in range(bits.eg(1)):
        a = next(v for v in range(vertices) if v not in seen)
        add((a, bits.tb(vertices), bits.tb(vertices)))
        while queue:
            x, y = queue.pop(0)
            if (x, y) not in open_edges:
                continue
            if bits.u(1) == 0:
                z = bits.tb(vertices)
            elif bits.u(1) == 0:
                z = next(end for start, end in reversed(open_edges) if start == y)
            elif bits.u(1) == 0:
                z = next(start for start, end in reversed(open_edges) if end == x)
            else:
                z = bits.tb(vertices)
            add((y, x, z))
    if open_edges or len(seen) != vertices:
        raise Damaged("the base mesh is not closed")
    return triangles


class Base:
    def __init__(self, data):
        bits = checked(data)
        if bits.u(32) != 0x4D464201:
            raise Damaged("no base of version 1")
        self.grid_bits = bits.u(5)
        self.splits = bits.eg(16)
        roots, self.virtuals = bits.eg(8), bits.eg(2)
        self.tables = Tables(bits)
        any_leaf, order = bits.u(1), bits.u(5)
        self.positions, self.levels = [], []  # level None: a leaf
        last = (0, 0, 0)
        for _ in range(roots):
            last = tuple(x + bits.zigzag(order) for x in last)
            self.positions.append(last)
            leaf = any_leaf and bits.u(1)
            self.levels.append(None if leaf else bits.u(self.tables.finest.bit_length()))
        self.triangles = base_triangles(bits, roots + self.virtuals)
        bits.end()


# --- records and chunks ----------------------------------------------------------------------------


class Record:
    """A node is (tree, path), the path a text of 0 and 1: then texts compare in preorder."""

    def __init__(self, bits, tables, level):
        context = min(tables.finest - level, 3)
        flags, length = tables.cut_lengths[tables.header[context].read(bits)]
        self.child_levels = [None, None]
        if flags == 0:
            both = tables.levels[context].read(bits)
            self.child_levels = [level + both // LEVELS, level + both % LEVELS]
        elif flags < 3:
            self.child_levels[1 if flags == 2 else 0] = level + tables.level[context].read(bits)
        class_b, class_c = divmod(tables.joint[context].read(bits), tables.classes)
        number = 4 * (min(max(class_b, class_c), 31) // 2) + context
        class_a = tables.residual[number].read(bits)
        self.b, self.c, self.residual = (value(bits, k) for k in (class_b, class_c, class_a))
        self.cut = bits.digits[bits.at:bits.at + length]
        bits.u(length)


def value(bits, value_class):
    if value_class == 0:
        return 0
    negative = bits.u(1)
    if value_class < 4:
        magnitude = value_class
    else:
        low = value_class // 2 - 1
        magnitude = (2 + value_class % 2 << low) + bits.u(low)
    return -magnitude if negative else magnitude


def read_set(bits):
    nodes, tree = [], -1
    for _ in range(bits.eg(3)):
        tree += 1 + bits.eg(0)
        stack = [""]
        while stack:
            path = stack.pop()
            visit = bits.u(2)
            if visit == 0:
                nodes.append((tree, path))
            stack += [path + "1"] * (visit & 1) + [path + "0"] * (visit >> 1)
    return nodes


def read_chunk(data, tables):
    """Its records by node."""
    bits = checked(data)
    if bits.u(32) != 0x4D464301:
        raise Damaged("no chunk of version 1")
    band, count = bits.u(5), bits.eg(9)
    records = {}
    for top in read_set(bits):
        stack = [top]
        while stack and len(records) < count:
            tree, path = stack.pop()
            record = records[tree, path] = Record(bits, tables, band)
            stack += [(tree, path + side) for side in "10"
                      if record.child_levels[int(side)] == band]
    bits.end()
    if len(records) != count:
        raise Damaged("a chunk with a wrong count")
    return records


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


# --- the cut code ----------------------------------------------------------------------------------


def parting(one, other):
    if one[0] != other[0]:
        return -1
    depth = 0
    for x, y in zip(one[1], other[1]):
        if x != y:
            return depth
        depth += 1
    raise Damaged("a node beside its ancestor")


def find_cut(entries, keys, region, tables):
    """The entries of l and r, and whether l comes first; keys[i] orders the face behind entry i."""
    size = len(entries)
    partings = [parting(entries[i], entries[(i + 1) % size]) for i in range(size)]
    earliest = min(partings)
    first_gap = min((i for i in range(size) if partings[i] == earliest), key=lambda i: keys[i])
    origin = (first_gap + 1) % size  # all places below are counted from here
    partings = partings[origin:] + partings[:origin]
    forward, backward = Bits(region), Bits(region[::-1])

    def cut(run, depth):
        begins = [run[0]] + [i + 1 for i in range(run[0], run[1] - 1) if partings[i] == depth]
        return list(zip(begins, begins[1:] + [run[1]]))

    def sub_runs(run):
        return cut(run, min(partings[run[0]:run[1] - 1]))

    def single(run):
        return run[1] - run[0] == 1

    runs = cut((0, size), earliest)
    count = len(runs)
    l_first = True
    if count <= RUNS_CODED:
        symbol = tables.cyclic[count].read(forward)
        l_first = symbol < count * count
        left, right = divmod(symbol, count) if l_first else (symbol - count * count,) * 2
    else:
        left, right = forward.tb(count), forward.tb(count)
        if left == right:
            l_first = forward.u(1) == 1
    left, right = runs[left], runs[right]
    while left == right and not single(left):
        runs = sub_runs(left)
        count = len(runs)
        if count <= RUNS_CODED:
            one, other = divmod(tables.linear[count, l_first].read(forward), count)
        else:
            one = forward.tb(count)
            other = one + forward.tb(count - one)
            if not l_first:
                one, other = other, one
        left, right = runs[one], runs[other]
    if left != right:
        while not single(left):
            runs = sub_runs(left)
            left = runs[forward.tb(len(runs))]
        while not single(right):
            runs = sub_runs(right)
            right = runs[backward.tb(len(runs))]
    if forward.at + backward.at > len(region):
        raise Damaged("a cut code that reads bits twice")
    return (left[0] + origin) % size, (right[0] + origin) % size, l_first


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
        self.nodes = [(tree, "") for tree in range(len(self.positions))]
        normals = root_normals(base.positions, base.triangles)
        self.normals = normals + [None] * base.virtuals
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
        left, right, l_first = find_cut([self.nodes[v] for v in ends],
                                        [self.keys[h // 3] for h in ring], record.cut, self.tables)
        t = len(self.nodes)
        self.place_child(node, record, u)
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
                   f"property double y\nproperty double z\nelement face {len(triangles)}\n"
                   "property list uchar int vertex_indices\nend_header\n")
        for v in used:
            file.write(" ".join(repr(o + step * x) for o, x in zip(origin, mesh.positions[v])) + "\n")
        for t in triangles:
            file.write("3 " + " ".join(str(number[v]) for v in t) + "\n")


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
