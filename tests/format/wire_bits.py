"""Bits, numbers, codes and checksums, as shared/codec/README.md says under "Bits and numbers"."""


class Damaged(Exception):
    pass


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


class Decisions:
    """Binary decisions of an arithmetic code; behind the last digit there are zeros."""

    def __init__(self, digits):
        self.digits = digits
        self.at = 0
        self.range = 1 << 32
        self.value = self.take(32)

    def take(self, count):
        digits = self.digits[self.at:self.at + count]
        self.at += count
        return int(digits.ljust(count, "0"), 2)

    def decide(self, chance_of_zero):
        bound = (self.range >> 6) * chance_of_zero
        bit = self.value >= bound
        if bit:
            self.value -= bound
            self.range -= bound
        else:
            self.range = bound
        while self.range < 1 << 24:
            self.value = self.value << 8 | self.take(8)
            self.range <<= 8
        return int(bit)
