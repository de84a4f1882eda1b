"""PyPI velodyne-decoder reads the lidar part of a log: its points and ours must be the same.

usage: velodyne_decoder_agrees.py LOG.pcapng SENSOR_FRAME.csv
Prints one JSON object: points of each and the largest difference of a coordinate, metres.
"""

import json
import sys

import dpkt
import numpy as np
import velodyne_decoder as vd

log, ours_csv = sys.argv[1:3]
config = vd.Config(model=vd.Model.VLP16, min_range=0.0, max_range=1000.0)
decoder = vd.StreamDecoder(config)
scans = []
# Its own read_pcap knows classic pcap alone; a log is pcapng, with the drive's frames between the lidar's.
with open(log, "rb") as file:
    for stamp, frame in dpkt.pcapng.Reader(file):
        try:
            udp = dpkt.ethernet.Ethernet(frame).data.data
        except (dpkt.UnpackError, AttributeError):
            continue
        payload = getattr(udp, "data", b"")
        if len(payload) != vd.PACKET_SIZE:
            continue
        scan = decoder.decode(stamp, payload, True)
        if scan is not None:
            scans.append(scan[1])
last = decoder.finish(True)
if last is not None:
    scans.append(last[1])
theirs = np.concatenate(scans)
ours = np.genfromtxt(ours_csv, delimiter=",", names=True)

result = {"theirs": len(theirs), "ours": len(ours)}
if len(theirs) == len(ours):
    # Both walk packets, firings and lasers in the order of the wire. Their axes: x forward, y left.
    result["same_rings"] = bool(np.array_equal(theirs["ring"], ours["ring"].astype(int)))
    pairs = [("x", -theirs["y"].astype(float)), ("y", theirs["x"].astype(float)), ("z", theirs["z"].astype(float))]
    result["max_difference_m"] = max(float(np.abs(ours[name] - column).max()) for name, column in pairs)
print(json.dumps(result))
