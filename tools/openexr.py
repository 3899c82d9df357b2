"""Reads the pictures that vitrum writes as OpenEXR: scanlines of 32-bit floats, not compressed or by ZIP."""

import itertools
import struct
import zlib

NO_COMPRESSION, ZIPS, ZIP = 0, 2, 3
FLOAT = 2


class NotReadable(Exception):
    """The file is no OpenEXR file of the kind above."""


def _text(data, at):
    """The text up to the next 0, and where what follows it begins."""
    end = data.index(0, at)
    return data[at:end].decode(), end + 1


def _attributes(data):
    """The header's attributes by name, and where what follows it begins."""
    attributes, at = {}, 8
    while True:
        name, at = _text(data, at)
        if not name:
            return attributes, at
        _, at = _text(data, at)
        size, = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size


def _channel_names(chlist):
    names, at = [], 0
    while chlist[at]:
        name, at = _text(chlist, at)
        kind, = struct.unpack_from("<i", chlist, at)
        if kind != FLOAT:
            raise NotReadable(f"channel {name} does not hold 32-bit floats")
        names.append(name)
        at += 16
    return names


def _unzipped(data):
    """Undoes ZIP: bytes are stored as differences, those at even places before those at odd ones."""
    flat = bytes(itertools.accumulate(zlib.decompress(data), lambda a, b: (a + b - 128) & 255))
    half = (len(flat) + 1) // 2
    raw = bytearray(len(flat))
    raw[0::2], raw[1::2] = flat[:half], flat[half:]
    return bytes(raw)


def read_exr(data):
    """(width, height, {channel: values by row from the top}) of a file's bytes. Raises NotReadable."""
    magic, version = struct.unpack_from("<iI", data)
    if magic != 20000630 or version >> 8:
        raise NotReadable("this is no OpenEXR file of plain scanlines")
    attributes, at = _attributes(data)
    names = _channel_names(attributes["channels"])
    compression = attributes["compression"][0]
    if compression not in (NO_COMPRESSION, ZIPS, ZIP):
        raise NotReadable(f"compression {compression} is not supported")
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    lines = 16 if compression == ZIP else 1
    chunks = -(-height // lines)

    planes = {name: [0.0] * (width * height) for name in names}
    for offset in struct.unpack_from(f"<{chunks}Q", data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        y -= top
        here = min(lines, height - y)
        raw = data[offset + 8:offset + 8 + size]
        if size < 4 * width * here * len(names):
            raw = _unzipped(raw)
        values = struct.unpack(f"<{width * here * len(names)}f", raw)
        rows = iter(range(0, len(values), width))
        for row in range(y, y + here):
            for name in names:
                first = next(rows)
                planes[name][row * width:(row + 1) * width] = values[first:first + width]
    return width, height, planes
