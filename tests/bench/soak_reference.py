"""What a service must answer, worked out from base mesh and chunks by the second decoder.

Base and chunks are taken once, while the service is quiet, and decoded whole (a wrong checksum or
count raises); every answer to a set of nodes is then put together here from single records, as
shared/codec/README.md says. Nodes are (tree, path), the path a text of 0 and 1.
"""
import json

import other_tests  # noqa: F401

from wire_bits import checked
from wire_records import Base, Record, read_set
from running_programs import ask


def crc_table():
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ 0x82F63B78 if value & 1 else value >> 1
        table.append(value)
    return table


CRC = crc_table()


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = crc >> 8 ^ CRC[(crc ^ byte) & 255]
    return crc ^ 0xFFFFFFFF


class Mesh:
    """One mesh: its resources as octets, its records as texts of bits."""

    def __init__(self, port, name):
        self.path = f"/v1/meshes/{name}"
        self.bodies = {"/v1/meshes": self.get(port, "/v1/meshes"), self.path: self.get(port, self.path)}
        metadata = json.loads(self.bodies[self.path])
        self.fixed = f"{self.path}/{metadata['revision']}"
        self.chunk_count, self.max_level = metadata["chunkCount"], metadata["maxLevel"]
        self.trees = metadata["baseVertexCount"]
        numbered = [f"{self.fixed}/chunks/{n}" for n in range(self.chunk_count)]
        for target in [f"{self.fixed}/base", f"{self.fixed}/chunks", *numbered]:
            self.bodies[target] = self.get(port, target)
        tables = Base(self.bodies[f"{self.fixed}/base"]).tables
        self.records = {}  # node -> (bits, level, levels of its children; None: a leaf)
        for target in numbered:
            self.read_chunk(self.bodies[target], tables)
        if len(self.records) != metadata["splitCount"]:
            raise RuntimeError(f"{name}: {len(self.records)} records in all chunks together")
        self.nodes = sorted(self.records)

    @staticmethod
    def get(port, target):
        response = ask(port, target)
        if response.status != 200:
            raise RuntimeError(f"{target} is answered with {response.status}")
        return response.body

    def read_chunk(self, data, tables):
        bits = checked(data)
        bits.u(32)
        band, count = bits.u(5), bits.eg(9)
        stack = read_set(bits)[::-1]
        for _ in range(count):
            tree, path = stack.pop()
            begin = bits.at
            record = Record(bits, tables, band)
            self.records[tree, path] = (bits.digits[begin:bits.at], band, record.child_levels)
            stack += [(tree, path + side) for side in "10" if record.child_levels[int(side)] == band]
        bits.end()

    def answer(self, nodes, levels=0, significance=None):
        """To a request for `nodes` in preorder."""
        texts = []
        for node in nodes:
            stack = [(node, 0)]
            while stack:
                (tree, path), below = stack.pop()
                text, _, children = self.records[tree, path]
                texts.append(text)
                for side in (1, 0):
                    level = children[side]
                    if level is None:
                        continue
                    if below < levels or (significance is not None and level <= significance):
                        stack.append(((tree, path + str(side)), below + 1))
        digits = "".join(texts)
        digits += "0" * (-len(digits) % 8)
        content = int(digits, 2).to_bytes(len(digits) // 8, "big")
        return content + crc32c(content).to_bytes(4, "little")

    def front(self, chance, count):
        """Some `count` random nodes with records, none above another, in preorder."""
        nodes = sorted(set(chance.choices(self.nodes, k=count)))
        chosen = []
        for tree, path in nodes:
            if not chosen or chosen[-1][0] != tree or not path.startswith(chosen[-1][1]):
                chosen.append((tree, path))
        return chosen
