"""Sets of nodes as they stand in requests: written a second time, on purpose.

A node is (tree, path), path a string of 0 and 1; sets are antichains.
"""
import base64


def exp_golomb(value, order):
    value += 1 << order
    return "0" * (value.bit_length() - order - 1) + format(value, "b")


def tree_visits(paths, prefix=""):
    if prefix in paths:
        return "00"
    left = any(p.startswith(prefix + "0") for p in paths)
    right = any(p.startswith(prefix + "1") for p in paths)
    bits = ("1" if left else "0") + ("1" if right else "0")
    if left:
        bits += tree_visits({p for p in paths if p.startswith(prefix + "0")}, prefix + "0")
    if right:
        bits += tree_visits({p for p in paths if p.startswith(prefix + "1")}, prefix + "1")
    return bits


def bitstring(nodes):
    trees = {}
    for tree, path in nodes:
        trees.setdefault(tree, set()).add(path)
    bits = exp_golomb(len(trees), 3)
    following = 0
    for tree in sorted(trees):
        bits += exp_golomb(tree - following, 0) + tree_visits(trees[tree])
        following = tree + 1
    bits += "0" * (-len(bits) % 8)
    return bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8))


def ids(nodes):
    return base64.urlsafe_b64encode(bitstring(nodes)).rstrip(b"=").decode()
