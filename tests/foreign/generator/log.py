"""Writes a log: pcapng with interface 0 for the lidar and interface 1 for the drive.

Written from the pcapng specification and the book's page on formats.
"""

import struct

ETHERNET = 1
USER0 = 147
SOCKETCAN = 227
INBOUND = 1
OUTBOUND = 2

LIDAR_ADDRESS = bytes([192, 168, 1, 201])


def _option(code, value):
    return struct.pack("<HH", code, len(value)) + value + bytes(-len(value) % 4)


def _block(kind, body):
    length = len(body) + 12
    return struct.pack("<II", kind, length) + body + struct.pack("<I", length)


def section(comments):
    options = b"".join(_option(1, c.encode()) for c in comments)
    options += _option(4, b"generator") + _option(0, b"")
    return _block(0x0A0D0D0A, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1) + options)


def interface(link, name):
    options = _option(2, name.encode()) + _option(9, b"\x09") + _option(0, b"")
    return _block(1, struct.pack("<HHI", link, 0, 0) + options)


def record(index, time_ns, data, direction):
    head = struct.pack(
        "<IIIII", index, time_ns >> 32, time_ns & 0xFFFFFFFF, len(data), len(data)
    )
    options = _option(2, struct.pack("<I", direction)) + _option(0, b"")
    return _block(6, head + data + bytes(-len(data) % 4) + options)


def udp(payload, port):
    """The Ethernet, IPv4 and UDP headers of a packet that the lidar broadcasts."""
    total = 28 + len(payload)
    ip = bytearray(
        struct.pack(">BBHHHBBH", 0x45, 0, total, 0, 0x4000, 64, 17, 0)
        + LIDAR_ADDRESS
        + b"\xff\xff\xff\xff"
    )
    words = sum(struct.unpack(">10H", ip))
    while words >> 16:
        words = (words & 0xFFFF) + (words >> 16)
    struct.pack_into(">H", ip, 10, ~words & 0xFFFF)
    ethernet = b"\xff" * 6 + b"\x60\x76\x88\x00\x00\x00" + b"\x08\x00"
    return ethernet + bytes(ip) + struct.pack(">HHHH", port, port, total - 20, 0) + payload


def write(path, comments, drive_link, drive_name, records):
    """`records`: (order, interface, host time in ns, bytes, direction), sorted by order."""
    with open(path, "wb") as file:
        file.write(section(comments))
        file.write(interface(ETHERNET, "lidar"))
        file.write(interface(drive_link, drive_name))
        for _, index, time_ns, data, direction in sorted(records, key=lambda r: r[0]):
            file.write(record(index, time_ns, data, direction))
