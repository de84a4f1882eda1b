#!/usr/bin/env python3
"""Checks the generator itself: frames against the maker's, packets through velodyne-decoder.

Prints one JSON object: points, and the distance of velodyne-decoder's from the generator's truth.
"""

import json

import numpy as np
import velodyne_decoder as vd

import clocks
import drive
import lidar


def main():
    drive.check_frames()
    packets = lidar.fire(
        clocks.Clock(offset=100.0),
        0.0,
        1.0,
        np.zeros_like,
        0.0,
        np.random.default_rng(1),
        share=1,
    )
    config = vd.Config(model=vd.Model.VLP16, min_range=0.0, max_range=1000.0)
    decoder = vd.StreamDecoder(config)
    scans = [
        decoder.decode(1e6 + sent, payload, True)
        for sent, payload in zip(packets.sent, packets.payloads)
    ]
    scans.append(decoder.finish(True))
    cloud = np.concatenate([scan[1] for scan in scans if scan is not None])
    # Theirs is x forward, y left.
    theirs = np.stack([-cloud["y"], cloud["x"], cloud["z"]], axis=1)
    rings = lidar.RING[packets.channel]
    worst, squares, points = 0.0, 0.0, 0
    for ring in range(16):
        mine = rings == ring
        theirs_here = cloud["ring"] == ring
        if not np.array_equal(cloud["intensity"][theirs_here], (packets.number % 256)[mine]):
            raise AssertionError(f"ring {ring} has other shots")
        away = np.linalg.norm(theirs[theirs_here] - packets.points[mine], axis=1)
        worst = max(worst, float(away.max()))
        squares += float((away**2).sum())
        points += len(away)
    rms = (squares / points) ** 0.5
    print(json.dumps({"points": points, "worst_m": worst, "rms_m": rms}))


if __name__ == "__main__":
    main()
