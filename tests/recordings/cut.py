#!/usr/bin/env python3
"""Cuts whole packets off the front of the recordings and counts what the cuts hold.

usage: cut.py FOLDER_OF_WHOLE_RECORDINGS    writes the cuts beside this file, prints their counts
       cut.py --count FILE...               prints the counts of any recording

Needs dpkt and numpy. The counts are independent of velomotion: dpkt reads the file, numpy decodes
the packets by the VLP-16 manual (63-9243, sections 7.5 and 9). Sums are those of README.md.
"""

import sys
from pathlib import Path

import dpkt
import numpy as np

# Data packets of each cut; None keeps the whole file, with its truncated end.
CUTS = {
    "vlp16-strongest-gps.pcap": 26,
    "vlp16-dual.pcap": 14,
    "vlp16-2014-no-factory-bytes.pcap": 115,
    "vlp16-fov-limited-malformed.pcap": None,
    "hdl32e-strongest.pcap": 8,
}
FILE_HEADER, RECORD_HEADER = 24, 16
# Ethernet, IPv4 without options, UDP.
HEADERS, DATA, POSITION = 14 + 20 + 8, 1206, 512
ELEVATION_DEG = np.array([-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15.0])
FIRING_US, CHANNEL_US = 55.296, 2.304
# A larger step between blocks is the edge of a limited field of view.
MAX_STEP_DEG = 5


def cut(data, packets):
    """The file's front, up to and including so many data packets."""
    if packets is None:
        return data
    at, seen = FILE_HEADER, 0
    while seen < packets:
        size = int.from_bytes(data[at + 8 : at + 12], "little")
        seen += size == HEADERS + DATA
        at += RECORD_HEADER + size
    return data[:at]


def count(path):
    """Packets, returns and sums of a recording."""
    data, positions = [], 0
    with open(path, "rb") as file:
        try:
            for _, frame in dpkt.pcap.Reader(file):
                if len(frame) == HEADERS + DATA:
                    data.append(bytes(frame)[HEADERS:])
                positions += len(frame) == HEADERS + POSITION
        except dpkt.dpkt.NeedData:
            pass
    packets = np.frombuffer(b"".join(data), np.uint8).reshape(-1, DATA)
    blocks = packets[:, :1200].reshape(-1, 12, 100)
    azimuth_deg = blocks[:, :, 2:4].copy().view("<u2")[:, :, 0] / 100
    distance = blocks[:, :, 4:].reshape(-1, 12, 32, 3)[..., :2].copy().view("<u2")[..., 0]
    is_dual = packets[0, 1204] == 0x39
    returns = unique = int((distance > 0).sum())
    if is_dual:
        last, strongest = distance[:, 0::2], distance[:, 1::2]
        unique -= int(((last == strongest) & (last > 0)).sum())
    result = {"data": len(data), "position": positions, "returns": returns, "unique": unique}
    if "hdl32e" not in str(path):
        result["sums"] = sums(azimuth_deg, distance, is_dual)
    return result


def sums(azimuth_deg, distance, is_dual):
    """Sums of x, y, z; the azimuth is interpolated by channel within a packet."""
    # A block holds two firings, and in dual mode a pair of blocks does.
    copies = 2 if is_dual else 1
    step_deg = np.diff(azimuth_deg[:, ::copies], axis=1) % 360
    step_deg = np.concatenate([step_deg, step_deg[:, -1:]], axis=1)
    step_deg = np.where(step_deg > MAX_STEP_DEG, np.median(step_deg), step_deg)
    rate = np.repeat(step_deg, copies, axis=1) / (2 * FIRING_US)
    channel = np.arange(32)
    delay_us = channel % 16 * CHANNEL_US + channel // 16 * FIRING_US
    angle = np.radians(azimuth_deg[:, :, None] + rate[:, :, None] * delay_us)
    elevation = np.radians(ELEVATION_DEG[channel % 16])
    range_m = distance * 0.002
    x = range_m * np.cos(elevation) * np.sin(angle)
    y = range_m * np.cos(elevation) * np.cos(angle)
    z = range_m * np.sin(elevation)
    return [round(float(axis.sum()), 3) for axis in (x, y, z)]


if sys.argv[1] == "--count":
    paths = [Path(name) for name in sys.argv[2:]]
else:
    paths = []
    for name, packets in CUTS.items():
        path = Path(__file__).parent / name
        path.write_bytes(cut((Path(sys.argv[1]) / name).read_bytes(), packets))
        paths.append(path)
for path in paths:
    print(path.name, path.stat().st_size, "bytes", count(path))
