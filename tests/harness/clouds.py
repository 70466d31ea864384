# SPDX-License-Identifier: GPL-3.0-or-later
"""Writers of point files, from the public specifications of the formats (ASPRS LAS 1.0 to 1.4, PCD 0.7, PLY), which share no code with the reader."""
import struct

import numpy as np

LAS_SIZES = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)
LAS_TIMED = {1, 3, 4, 5, 6, 7, 8, 9, 10}


def las_record(fmt, point, extra):
    """The bytes of one point: X, Y, Z (integers), intensity, return, of, classification, withheld, t."""
    out = struct.pack("<iiiH", *point["xyz"], point["intensity"])
    if fmt < 6:
        out += struct.pack("<BBbBH", point["return"] | point["of"] << 3, point["class"] | point["withheld"] << 7, -12, 34, 56)
        if fmt in LAS_TIMED:
            out += struct.pack("<d", point["t"])
        if fmt in (2, 3, 5):
            out += struct.pack("<HHH", 1, 2, 3)
    else:
        out += struct.pack("<BBBBhH", point["return"] | point["of"] << 4, point["withheld"] << 2, point["class"], 34, -120, 56)
        out += struct.pack("<d", point["t"])
        if fmt in (7, 8, 10):
            out += struct.pack("<HHH", 1, 2, 3)
        if fmt in (8, 10):
            out += struct.pack("<H", 4)
    if fmt in (4, 5, 9, 10):
        out += struct.pack("<BQIffff", 1, 2, 3, 4, 5, 6, 7)
    assert len(out) == LAS_SIZES[fmt]
    return out + bytes(extra)


def las_vlr(user, number, content):
    return struct.pack("<H16sHH32s", 0, user.encode(), number, len(content), b"") + content


def las(points, fmt=0, minor=2, scale=0.001, offset=(0.0, 0.0, 0.0), extra=0, records=(), encoding=0, count=None, long_records=(), box=None):
    """A LAS 1.`minor` file of point format `fmt`, with `extra` bytes behind every point; the box is max, min of x, y, z, by default that of the points."""
    body = b"".join(las_record(fmt, point, extra) for point in points)
    size = {0: 227, 1: 227, 2: 227, 3: 235, 4: 375}[minor]
    between = b"".join(records)
    begin = size + len(between) + (2 if minor == 0 else 0)
    count = len(points) if count is None else count
    head = b"LASF" + struct.pack("<HH16s", 0, encoding if minor else 0, b"") + bytes([1, minor]) + b"test".ljust(32, b"\0") * 2
    head += struct.pack("<HHHIIBHI", 1, 2026, size, begin, len(records), fmt, LAS_SIZES[fmt] + extra, 0 if fmt > 5 else count)
    by_return = np.bincount([p["return"] for p in points], minlength=16)
    head += struct.pack("<5I", *(by_return[1:6] if fmt < 6 else [0] * 5)) + struct.pack("<3d", *([scale] * 3)) + struct.pack("<3d", *offset)
    xyz = np.array([p["xyz"] for p in points]).reshape(-1, 3) * scale + offset
    if box is None:
        box = [edge(xyz[:, k]) for k in range(3) for edge in (np.max, np.min)] if points else [0.0] * 6
    head += struct.pack("<6d", *box)
    assert len(head) == 227
    if minor >= 3:
        head += struct.pack("<Q", 0)
    if minor == 4:
        head += struct.pack("<QI", begin + len(body) if long_records else 0, len(long_records)) + struct.pack("<Q", count) + struct.pack("<15Q", *by_return[1:16])
    assert len(head) == size
    return head + between + (b"\xdd\xcc" if minor == 0 else b"") + body + b"".join(long_records)


def las_points(count=500, seed=1):
    """Points with every field, as LAS stores them."""
    random = np.random.default_rng(seed)
    xyz = random.integers(-40000, 40000, (count, 3))
    return [{"xyz": tuple(int(v) for v in xyz[i]), "intensity": int(random.integers(0, 65536)), "return": int(random.integers(1, 6)), "of": 5,
             "class": int(random.choice([1, 2, 7])), "withheld": 0, "t": 400000.25 + i / 1024} for i in range(count)]


def lzf(data):
    """LibLZF: literal runs of up to 32 bytes, and references to equal bytes up to 8191 before."""
    out = bytearray()
    literals = bytearray()
    seen = {}

    def flush():
        while literals:
            part = literals[:32]
            del literals[:32]
            out.append(len(part) - 1)
            out.extend(part)

    i = 0
    while i < len(data):
        key = bytes(data[i:i + 3])
        back = i - seen.get(key, -10**9)
        if len(key) == 3 and 1 <= back <= 8191:
            length = 3
            while length < 264 and i + length < len(data) and data[i + length] == data[i + length - back]:
                length += 1
            flush()
            code = length - 2
            if code < 7:
                out.append(code << 5 | (back - 1) >> 8)
            else:
                out.append(7 << 5 | (back - 1) >> 8)
                out.append(code - 7)
            out.append((back - 1) & 255)
        else:
            length = 1
            literals.append(data[i])
        for k in range(i, i + length):
            seen[bytes(data[k:k + 3])] = k
        i += length
    flush()
    return bytes(out)


def pcd(table, form="binary", header=""):
    """A structured array as PCD."""
    kinds = {"f": "F", "i": "I", "u": "U"}
    names = table.dtype.names
    types = [table.dtype[name] for name in names]
    text = ("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
            f"FIELDS {' '.join(names)}\nSIZE {' '.join(str(t.itemsize) for t in types)}\nTYPE {' '.join(kinds[t.kind] for t in types)}\n"
            f"COUNT {' '.join('1' for _ in names)}\nWIDTH {len(table)}\nHEIGHT 1\n{header or 'VIEWPOINT 0 0 0 1 0 0 0'}\nPOINTS {len(table)}\nDATA {form}\n").encode()
    if form == "ascii":
        return text + "".join(" ".join(repr(v.item()) for v in row) + "\n" for row in table).encode()
    if form == "binary":
        return text + table.tobytes()
    raw = b"".join(np.ascontiguousarray(table[name]).tobytes() for name in names)
    packed = lzf(raw)
    return text + struct.pack("<II", len(packed), len(raw)) + packed


def ply(table, form="binary_little_endian", faces=0):
    """A structured array as the vertices of a PLY."""
    kinds = {"f4": "float", "f8": "double", "i4": "int", "u1": "uchar", "i2": "short", "u2": "ushort", "i1": "char", "u4": "uint"}
    text = f"ply\nformat {form} 1.0\ncomment by a test\nelement vertex {len(table)}\n"
    for name in table.dtype.names:
        text += f"property {kinds[table.dtype[name].str[1:]]} {name}\n"
    if faces:
        text += f"element face {faces}\nproperty list uchar int vertex_indices\n"
    out = (text + "end_header\n").encode()
    order = ">" if form == "binary_big_endian" else "<"
    if form == "ascii":
        return out + "".join(" ".join(repr(v.item()) for v in row) + "\n" for row in table).encode() + b"3 0 1 2\n" * faces
    return out + table.astype(table.dtype.newbyteorder(order)).tobytes() + struct.pack(order + "Biii", 3, 0, 1, 2) * faces
