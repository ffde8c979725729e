"""Joins PNG pictures of one size side by side, with the standard library alone.

    python3 png_strip.py OUTPUT.png INPUT.png...
"""

import struct
import sys
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"
RGB = 2  # PNG's colour type
GAP = 8  # white columns between pictures


def read_rgb(path):
    """Width, height and the rows of an 8-bit RGB picture that is not interlaced."""
    with open(path, "rb") as file:
        data = file.read()
    if not data.startswith(SIGNATURE):
        raise ValueError(f"{path} is no PNG")
    at = len(SIGNATURE)
    packed = b""
    width = height = 0
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        content = data[at + 8:at + 8 + length]
        at += 12 + length
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", content)
            if (depth, colour, interlaced) != (8, RGB, 0):
                raise ValueError(f"{path} is not plain 8-bit RGB")
        elif kind == b"IDAT":
            packed += content
    return width, height, unfiltered(zlib.decompress(packed), height, 3 * width)


def unfiltered(raw, height, stride):
    """The rows behind PNG's filters (PNG specification, section 9)."""
    rows = []
    above = bytearray(stride)
    for y in range(height):
        begin = y * (stride + 1)
        kind = raw[begin]
        row = bytearray(raw[begin + 1:begin + 1 + stride])
        for i in range(stride):
            left = row[i - 3] if i >= 3 else 0
            if kind == 1:
                row[i] = (row[i] + left) & 255
            elif kind == 2:
                row[i] = (row[i] + above[i]) & 255
            elif kind == 3:
                row[i] = (row[i] + (left + above[i]) // 2) & 255
            elif kind == 4:
                row[i] = (row[i] + paeth(left, above[i], above[i - 3] if i >= 3 else 0)) & 255
        rows.append(row)
        above = row
    return rows


def paeth(left, above, corner):
    guess = left + above - corner
    distances = (abs(guess - left), abs(guess - above), abs(guess - corner))
    return (left, above, corner)[distances.index(min(distances))]


def chunk(kind, content):
    body = kind + content
    return struct.pack(">I", len(content)) + body + struct.pack(">I", zlib.crc32(body))


def write_rgb(path, width, rows):
    """Each row as its difference from the row above, which suits shaded pictures."""
    packer = zlib.compressobj(9)
    packed = b""
    above = bytes(3 * width)
    for row in rows:
        packed += packer.compress(b"\x02" + bytes((a - b) & 255 for a, b in zip(row, above)))
        above = row
    packed += packer.flush()
    header = struct.pack(">IIBBBBB", width, len(rows), 8, RGB, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(SIGNATURE + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def join(output, inputs):
    pictures = [read_rgb(path) for path in inputs]
    height = pictures[0][1]
    if any(picture[1] != height for picture in pictures):
        raise ValueError("the pictures differ in height")
    gap = b"\xff" * (3 * GAP)
    rows = [gap.join(bytes(picture[2][y]) for picture in pictures) for y in range(height)]
    write_rgb(output, len(rows[0]) // 3, rows)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    join(sys.argv[1], sys.argv[2:])
