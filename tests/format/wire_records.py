"""The base resource, records and chunks, as shared/codec/README.md describes them."""

from wire_bits import Damaged, Huffman, checked

LEVELS = 32
CONTEXTS = 803  # of the cut code


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
        self.chances = read_chances(bits)
        self.colours, self.normal_bits = bits.u(1), bits.u(4)
        if bits.u(1):
            raise Damaged("attributes that this page does not know")
        if self.colours:
            self.green = [Huffman(bits, 16) for _ in range(4)]
            self.red = [Huffman(bits, 18) for _ in range(8)]
            self.blue = [Huffman(bits, 18) for _ in range(8)]
            self.alpha = Huffman(bits, 16)
        if self.normal_bits:
            self.normal = [Huffman(bits, 4 * self.normal_bits ** 2) for _ in range(4)]


def read_chances(bits):
    """The cut code's, by context."""
    chances, last = [], 32
    while len(chances) < CONTEXTS:
        chances += [last] * bits.eg(1)
        if len(chances) < CONTEXTS:
            sign = -1 if bits.u(1) else 1
            last += sign * (bits.eg(1) + 1)
            if not 0 < last < 64:
                raise Damaged("an impossible chance")
            chances.append(last)
    if len(chances) > CONTEXTS:
        raise Damaged("more chances than contexts")
    return chances


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
        if bits.u(32) != 0x4D464202:
            raise Damaged("no base of version 2")
        self.grid_bits = bits.u(5)
        self.splits = bits.eg(16)
        roots, self.virtuals = bits.eg(8), bits.eg(2)
        self.tables = Tables(bits)
        any_leaf, order = bits.u(1), bits.u(5)
        self.positions, self.levels = [], []  # level None: a leaf
        self.colours, self.normals = [], []
        last, colour, normal = (0, 0, 0), (0, 0, 0, 255), (0, 0)
        for _ in range(roots):
            last = tuple(x + bits.zigzag(order) for x in last)
            self.positions.append(last)
            if self.tables.colours:
                colour = tuple(x + bits.zigzag(3) for x in colour)
            if self.tables.normal_bits:
                normal = tuple(x + bits.zigzag(self.tables.normal_bits - 4) for x in normal)
            self.colours.append(colour)
            self.normals.append(normal)
            leaf = any_leaf and bits.u(1)
            self.levels.append(None if leaf else bits.u(self.tables.finest.bit_length()))
        self.triangles = base_triangles(bits, roots + self.virtuals)
        bits.end()


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
        self.colour, self.normal = (0, 0, 0, 0), (0, 0)
        if tables.colours:
            green = tables.green[context].read(bits)
            classes = (green, tables.red[min(green // 2, 7)].read(bits),
                       tables.blue[min(green // 2, 7)].read(bits), tables.alpha.read(bits))
            green, red, blue, alpha = (value(bits, k) for k in classes)
            self.colour = (red + green, green, blue + green, alpha)
        if tables.normal_bits:
            classes = divmod(tables.normal[context].read(bits), 2 * tables.normal_bits)
            self.normal = tuple(value(bits, k) for k in classes)
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
    if bits.u(32) != 0x4D464302:
        raise Damaged("no chunk of version 2")
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
