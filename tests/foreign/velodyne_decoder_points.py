"""PyPI velodyne-decoder reads the lidar part of a log; its points go out as they are.

usage: velodyne_decoder_points.py LOG.pcapng MODEL POINTS.f64
Writes x, y, z of every point (x right, y forward, z up; metres, little-endian f64) and prints one JSON object with their number.
"""

import json
import sys

import dpkt
import numpy as np
import velodyne_decoder as vd

log, model, points = sys.argv[1:4]
config = vd.Config(model=getattr(vd.Model, model), min_range=0.0, max_range=1000.0)
decoder = vd.StreamDecoder(config)
scans = []
with open(log, "rb") as file:
    for stamp, frame in dpkt.pcapng.Reader(file):
        try:
            udp = dpkt.ethernet.Ethernet(frame).data.data
        except (dpkt.UnpackError, AttributeError):
            continue
        payload = getattr(udp, "data", b"")
        if len(payload) == vd.PACKET_SIZE:
            scans.append(decoder.decode(stamp, payload, True))
scans.append(decoder.finish(True))
cloud = np.concatenate([scan[1] for scan in scans if scan is not None])
# Theirs is x forward, y left.
np.stack([-cloud["y"], cloud["x"], cloud["z"]], axis=1).astype("<f8").tofile(points)
print(json.dumps({"points": len(cloud)}))
