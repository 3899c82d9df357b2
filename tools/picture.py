"""What the makers of textures share: sRGB values and PNG files."""

import struct
import zlib


def srgb_byte(linear, step=1):
    """8-bit sRGB value (IEC 61966-2-1) of a reflectance, rounded to a multiple of `step`. 1 and all above are white."""
    linear = min(1.0, linear)
    value = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return min(255, step * round(255 * value / step))


def png(rows):
    """The bytes of an 8-bit sRGB PNG; a row is the bytes of its pixels' red, green and blue.

    Each row takes the filter whose differences are the smallest, as the standard advises.
    """

    def paeth(a, b, c):
        p = a + b - c
        pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
        return a if pa <= pb and pa <= pc else b if pb <= pc else c

    filters = (lambda a, b, c: 0, lambda a, b, c: a, lambda a, b, c: b, lambda a, b, c: (a + b) // 2, paeth)
    data = bytearray()
    above = bytes(len(rows[0]))
    for line in rows:
        left, above_left = bytes(3) + line[:-3], bytes(3) + above[:-3]
        tries = []
        for number, guess in enumerate(filters):
            filtered = bytes((v - guess(a, b, c)) & 255 for v, a, b, c in zip(line, left, above, above_left))
            tries.append((sum(min(v, 256 - v) for v in filtered), number, filtered))
        _, number, filtered = min(tries)
        data.append(number)
        data += filtered
        above = line

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", len(rows[0]) // 3, len(rows), 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"sRGB", b"\0") +
            chunk(b"IDAT", zlib.compress(bytes(data), 9)) + chunk(b"IEND", b""))
