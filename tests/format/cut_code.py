"""Where a ring is cut, as shared/codec/README.md says under "Cut code"."""

from wire_bits import Damaged, Decisions

RUNS_CODED = 6
# Contexts are numbered through: cyclic trees, linear trees, steps.
CYCLIC = {2: 0, 3: 128, 4: 144, 5: 176, 6: 208}
LINEAR = {2: 272, 3: 400, 4: 416, 5: 448, 6: 480}
LINEAR_TREE = {2: 4, 3: 8, 4: 16, 5: 16, 6: 32}
STEPS = 544


class Frame:
    """The tangent plane at s: x along d, y to the left of it."""

    def __init__(self, s, d, n):
        self.s, self.d = s, d
        self.aside = [n[(i + 1) % 3] * d[(i + 2) % 3] - n[(i + 2) % 3] * d[(i + 1) % 3]
                      for i in range(3)]
        self.square = sum(x * x for x in d) << 6

    def place(self, position):
        """(x, y), or None for a virtual vertex."""
        if position is None:
            return None
        q = [x - y for x, y in zip(position, self.s)]
        return (sum(x * y for x, y in zip(q, self.d)) << 6,
                sum(x * y for x, y in zip(q, self.aside)) >> 8)

    def pair(self, first, second):
        (fx, fy), (sx, sy) = first or (0, 0), second or (0, 0)
        return 8 * (2 * fx > self.square) + 4 * (2 * sx > self.square) + 2 * (fy > 0) + (sy > 0)

    def step(self, near, far, right):
        if near is None or far is None:
            return 256 + (near is not None) + 2 * (far is not None)
        sign = -1 if right else 1
        (nx, ny), (fx, fy), s = near, far, self.square
        ny, fy = sign * ny, sign * fy
        sides = 2 * (ny > 0) + (fy > 0)
        middle = nx + fx - s
        ahead = 0 if middle < -s else 1 if middle < 0 else 2 if middle < s else 3
        shift = max(0, max(abs(x) for x in (nx, ny, fx, fy, s)).bit_length() - 13)
        s, nx, ny, fx, fy = (x >> shift for x in (s, nx, ny, fx, fy))
        cos_t, sin_t = -s * (nx - s), abs(s * ny)
        cos_f = -fx * (nx - fx) - fy * (ny - fy)
        sin_f = abs(fx * (ny - fy) - fy * (nx - fx))
        return (sides * 4 + ahead) * 16 + angle(sin_t * cos_f + cos_t * sin_f,
                                                cos_t * cos_f - sin_t * sin_f)


def angle(sine, cosine):
    rise, run = abs(sine), -cosine
    bounds = ((8, 1), (4, 1), (2, 1), (4, 3), (4, 5), (1, 2), (1, 4))
    step = next((i for i, (p, q) in enumerate(bounds) if p * rise < q * run), 7)
    return 8 + step if sine > 0 else 7 - step


def symbol_of(count, decide):
    """One of `count` symbols; decide(node) for the nodes of the tree, from 1."""
    symbol, node = 0, 1
    for i in reversed(range((count - 1).bit_length())):
        bit = 0 if (2 * symbol + 1) << i >= count else decide(node)
        symbol, node = 2 * symbol + bit, 2 * node + bit
    return symbol


def parting(one, other):
    if one[0] != other[0]:
        return -1
    depth = 0
    for x, y in zip(one[1], other[1]):
        if x != y:
            return depth
        depth += 1
    raise Damaged("a node beside its ancestor")


def find_cut(entries, keys, region, chances, frame, position_of):
    """The entries of l and r, and whether l comes first; keys[i] orders the face behind entry i;
    position_of(node)."""
    size = len(entries)
    partings = [parting(entries[i], entries[(i + 1) % size]) for i in range(size)]
    earliest = min(partings)
    first_gap = min((i for i in range(size) if partings[i] == earliest), key=lambda i: keys[i])
    origin = (first_gap + 1) % size  # all places below are counted from here
    partings = partings[origin:] + partings[:origin]
    entries = entries[origin:] + entries[:origin]
    forward, backward = Decisions(region), Decisions(region[::-1])

    def cut(run, depth):
        begins = [run[0]] + [i + 1 for i in range(run[0], run[1] - 1) if partings[i] == depth]
        return list(zip(begins, begins[1:] + [run[1]]))

    def sub_runs(run):
        depth = min(partings[run[0]:run[1] - 1])
        return cut(run, depth), depth

    def places(runs, depth):
        nodes = [entries[begin] for begin, _ in runs]
        return [frame.place(position_of((tree, path[:depth + 1]))) for tree, path in nodes]

    def single(run):
        return run[1] - run[0] == 1

    def coded(count, first):
        return symbol_of(count, lambda node: forward.decide(chances[first + node]))

    def even(count):
        return symbol_of(count, lambda node: forward.decide(32))

    def walk(run, decisions, right):
        """Alone down to a single entry; sub-runs count from t's side on."""
        while not single(run):
            runs, depth = sub_runs(run)
            at = places(runs, depth)
            if right:
                runs.reverse()
                at.reverse()
            k = 0
            while k + 1 < len(runs) and decisions.decide(
                    chances[STEPS + frame.step(at[k], at[k + 1], right)]):
                k += 1
            run = runs[k]
        return run

    runs = cut((0, size), earliest)
    count = len(runs)
    l_first = True
    if count <= RUNS_CODED:
        pair = frame.pair(*places(runs, earliest)) if count == 2 else 0
        symbol = coded(count * count + count, CYCLIC[count] + 8 * pair)
        l_first = symbol < count * count
        left, right = divmod(symbol, count) if l_first else (symbol - count * count,) * 2
    else:
        left, right = even(count), even(count)
        if left == right:
            l_first = forward.decide(32) == 1
    left, right = runs[left], runs[right]
    while left == right and not single(left):
        runs, depth = sub_runs(left)
        count = len(runs)
        if count <= RUNS_CODED:
            pair = frame.pair(*places(runs, depth)) if count == 2 else 0
            pairs = [(i, j) for i in range(count) for j in range(i, count)]
            one, other = pairs[coded(len(pairs),
                                     LINEAR[count] + (2 * pair + l_first) * LINEAR_TREE[count])]
        else:
            one = even(count)
            other = one + even(count - one)
        left, right = (runs[one], runs[other]) if l_first else (runs[other], runs[one])
    if left != right:
        left = walk(left, forward, False)
        right = walk(right, backward, True)
    return (left[0] + origin) % size, (right[0] + origin) % size, l_first
