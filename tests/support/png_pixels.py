"""Reads PNG files of 8 bits per channel, RGB, not interlaced: those that Keylume writes (ISO/IEC 15948)."""
import struct
import zlib

import numpy


def png_pixels(path):
    """-> (height, width, 3) uint8"""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colours, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert (depth, colours, interlaced) == (8, 2, 0), path
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + 3 * width)
    return numpy.array(unfiltered(rows, width), numpy.uint8)


def unfiltered(rows, width):
    above = numpy.zeros((width, 3), int)
    pixels = []
    for row in rows:
        line, kind = row[1:].reshape(width, 3).astype(int), row[0]
        if kind == 2:
            line = (line + above) % 256
        elif kind:
            line = undo(kind, line, above, width)
        pixels.append(line)
        above = line
    return pixels


def undo(kind, line, above, width):
    """Sub, average and Paeth need the pixel on the left, one after the other."""
    left, corner = numpy.zeros(3, int), numpy.zeros(3, int)
    for x in range(width):
        if kind == 1:
            guess = left
        elif kind == 3:
            guess = (left + above[x]) // 2
        else:
            a, b, c = left, above[x], corner
            p = a + b - c
            pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
            guess = numpy.where((pa <= pb) & (pa <= pc), a, numpy.where(pb <= pc, b, c))
        left, corner = (line[x] + guess) % 256, above[x]
        line[x] = left
    return line


def light_of(pixels):
    """sRGB 0 .. 255 -> light 0 .. 1 (IEC 61966-2-1)."""
    value = pixels / 255
    return numpy.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def shown(light):
    """The other way, clipped at white."""
    light = numpy.clip(light, 0, 1)
    return 255 * numpy.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
