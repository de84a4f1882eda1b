#!/usr/bin/env python3
"""Compares velomotion with PyPI's velodyne-decoder: pcap files to numpy arrays, on one core, in one run.

usage: speed.py [--repetitions N] [--least RATIO] RECORDING.pcap ...

Both give structured arrays of points. They take turns, so that other work on the machine meets both. A time is CPU time
of all threads; a ratio is that of neighbouring turns, printed as median (least..most). velodyne-decoder has x, y, z,
intensity, time, column, ring and kind of return in 24 bytes; velomotion the documented 40 with range, azimuth and tilt.
"""

import argparse
import os
import statistics
import sys
import time
import warnings
from importlib.metadata import version

import numpy as np
import velodyne_decoder as vd
import velomotion

LEAST_S = 0.2
MODELS = {"VLP-16": "VLP16", "Puck Hi-Res": "PuckHiRes", "HDL-32E": "HDL32E", "VLP-32C": "VLP32C"}


def measure(work):
    """CPU seconds per call, over calls of LEAST_S, and points."""
    calls, began = 0, time.process_time()
    while (taken := time.process_time() - began) < LEAST_S:
        points = work()
        calls += 1
    return taken / calls, points


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", nargs="+")
    parser.add_argument("--repetitions", type=int, default=9)
    parser.add_argument("--least", type=float, default=0, help="a smaller ratio is a failure")
    arguments = parser.parse_args()
    # The reader of frames has a thread of its own, which may not run beside Python's.
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    warnings.simplefilter("ignore", velomotion.IncompleteWarning)
    warnings.simplefilter("ignore", velomotion.RecordingWarning)
    print(f"velomotion {velomotion.__version__}, velodyne-decoder {version('velodyne-decoder')}, load {os.getloadavg()[0]:.1f}")
    slow = []
    for path in arguments.recordings:
        model = MODELS[velomotion.Log(path).info()["model"]]
        config = vd.Config(model=getattr(vd.Model, model), min_range=0.0, max_range=1000.0)

        def theirs():
            return sum(len(points) for _, points in vd.read_pcap(path, config, as_pcl_structs=True))

        def theirs_joined():
            return len(np.concatenate([points for _, points in vd.read_pcap(path, config, as_pcl_structs=True)]))

        contests = {
            "frame by frame": (theirs, lambda: sum(map(len, velomotion.frames(path)))),
            "one array": (theirs_joined, lambda: len(velomotion.read(path))),
            "one array, its fields": (
                theirs_joined,
                lambda: len(velomotion.read(path, fields=["x", "y", "z", "intensity", "time", "ring", "echo"])),
            ),
        }
        try:
            theirs()
        except RuntimeError as error:
            # It refuses other factory bytes than its model's.
            print(f"{os.path.basename(path)}: velodyne-decoder: {error}")
            continue
        print(f"{os.path.basename(path)}: {theirs()} points of velodyne-decoder, {len(velomotion.read(path))} of velomotion")
        for name, (their_work, our_work) in contests.items():
            ratios, rates = [], []
            for _ in range(arguments.repetitions):
                (their_s, their_points), (our_s, our_points) = measure(their_work), measure(our_work)
                ratios.append((our_points / our_s) / (their_points / their_s))
                rates.append((their_points / their_s * 1e-6, our_points / our_s * 1e-6))
            if statistics.median(ratios) < arguments.least:
                slow.append(f"{os.path.basename(path)}, {name}")
            theirs_rate, ours_rate = (statistics.median(column) for column in zip(*rates))
            print(
                f"  {name}: {statistics.median(ratios):.1f} ({min(ratios):.1f}..{max(ratios):.1f}) times as fast: "
                f"{ours_rate:.1f} against {theirs_rate:.1f} million points/s"
            )
    if slow:
        sys.exit(f"below {arguments.least:g}: {'; '.join(slow)}")


if __name__ == "__main__":
    main()
