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
with open(ours_csv) as file:
    rows = [line for line in file if not line.startswith("#")]
ours = np.genfromtxt(rows, delimiter=",", names=True)

result = {"theirs": len(theirs), "ours": len(ours)}
if len(theirs) == len(ours):
    # Both walk packets, firings and lasers in the order of the wire. Their axes: x forward, y left.
    result["same_rings"] = bool(np.array_equal(theirs["ring"], ours["ring"].astype(int)))
    theirs = np.stack([-theirs["y"], theirs["x"], theirs["z"]], axis=1).astype(float)
    ours = np.stack([ours["x_m"], ours["y_m"], ours["z_m"]], axis=1)
    result["max_difference_m"] = float(np.abs(ours - theirs).max())
    # They round every return's azimuth to 0.01 degrees (3 mm at 17 m) and count the rate in whole steps a block; we do neither.
    # So azimuths are compared apart, and points with ours turned onto theirs.
    theirs_deg = np.degrees(np.arctan2(theirs[:, 0], theirs[:, 1]))
    turn = np.radians(theirs_deg) - np.arctan2(ours[:, 0], ours[:, 1])
    turn = (turn + np.pi) % (2 * np.pi) - np.pi
    sin, cos = np.sin(turn), np.cos(turn)
    turned = np.stack([ours[:, 0] * cos + ours[:, 1] * sin, ours[:, 1] * cos - ours[:, 0] * sin, ours[:, 2]], axis=1)
    result["max_azimuth_difference_deg"] = float(np.degrees(np.abs(turn)).max())
    result["their_azimuth_off_grid_deg"] = float(np.abs(theirs_deg - np.round(theirs_deg, 2)).max())
    result["max_difference_turned_m"] = float(np.abs(turned - theirs).max())
    near = np.linalg.norm(ours, axis=1) < 4.0
    result["near"] = int(near.sum())
    result["max_difference_near_m"] = float(np.abs(ours - theirs)[near].max())
print(json.dumps(result))
