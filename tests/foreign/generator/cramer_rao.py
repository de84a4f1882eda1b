#!/usr/bin/env python3
"""What the samples of a scan allow at best, beside what a program makes of them.

    cramer_rao.py --program PATH [--seeds N]

The Cramer-Rao bound of the commanded motion (start, speed, both ramps, beginning, way) from the
polls of a scan, with their true errors: no unbiased estimate of these parameters has a smaller
standard deviation. A delay that all polls share is left out, as in the columns of the program.
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np

import compare
import scan
from conditions import ALL
from mechanism import COUNT_DEG, Profile

NAMES = (
    "plain, 56.25 deg/s",
    "plain, 20 deg/s",
    "plain, 5 deg/s",
    "plain, 98 deg/s",
    "plain, 100 Hz",
    "plain, 1000 Hz",
    "RS232, 56.25 deg/s",
    "CAN, 56.25 deg/s",
    "latch 1 ms, 56.25 deg/s, 400 Hz",
    "latch 1 ms, 56.25 deg/s, 1000 Hz",
)


def angle(parameters, t):
    """A trapezoid whose ramps may differ."""
    start, speed, up, down, begin, way = parameters
    cruise = way / speed - (up + down) / 2
    s = np.clip(t - start, 0.0, up + cruise + down)
    a, b, c = np.minimum(s, up), np.clip(s - up, 0, cruise), np.clip(s - up - cruise, 0, down)
    return begin + speed * (a * a / (2 * up) + b + c - c * c / (2 * down))


def derivatives(parameters, t):
    columns = []
    for i, value in enumerate(parameters):
        step = 1e-6 * max(1.0, abs(value))
        high, low = (
            [p + sign * step * (k == i) for k, p in enumerate(parameters)] for sign in (1, -1)
        )
        columns.append((angle(high, t) - angle(low, t)) / (2 * step))
    return np.stack(columns, axis=1)


def bound(truth):
    """Standard deviation of the angle over the move: root mean square, and greatest."""
    move = truth.setup.moves[0]
    begin, end = truth.begins[0], truth.ends[0]
    profile = Profile(begin, truth.setup.start, move.to, move.speed, move.accel)
    sign = profile.sign
    parameters = [begin, sign * profile.speed, profile.up, profile.down, profile.start]
    parameters.append(move.to - truth.setup.start)
    sent, received, degrees = (np.array(a) for a in zip(*truth.samples))
    trip = received - sent
    middle = (sent + received) / 2
    good = (trip <= np.quantile(trip, 0.9)) & (middle > begin - 0.06) & (middle < end + 0.06)
    middle, degrees = middle[good], degrees[good]
    rate = truth.motion.rate(middle)
    # Of a sample in the cruise: the error of its instant, and its count.
    cruise = np.abs(rate) > 0.95 * profile.speed
    off = (degrees - truth.motion(middle))[cruise]
    of_count = COUNT_DEG / np.sqrt(12)
    of_time = np.sqrt(max(np.var(off) - of_count**2, 0.0)) / profile.speed
    # Errors of instants are as large as the trips: the program knows these.
    trip = np.maximum(trip[good], 1e-9)
    of_time = of_time * trip / np.sqrt(np.mean(trip[cruise] ** 2))
    sd = np.hypot(of_count, of_time * rate)
    # At rest equal samples are one.
    resting = np.abs(rate) < 1e-6
    sd[resting] *= np.sqrt(max(resting.sum() / 2, 1))
    rows = derivatives(parameters, middle) / sd[:, None]
    covariance = np.linalg.pinv(rows.T @ rows)
    instants = np.linspace(begin, end, 2000)
    along = derivatives(parameters, instants)
    rate = truth.motion.rate(instants)
    along -= np.outer(rate, rate @ along) / (rate @ rate)
    variance = np.einsum("ij,jk,ik->i", along, covariance, along)
    return np.sqrt(variance.mean()), np.sqrt(variance.max())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--seeds", type=int, default=4)
    arguments = parser.parse_args()
    titles = ("condition", "RMS deg", "Cramer-Rao RMS", "worst deg", "3 x Cramer-Rao, greatest")
    print("| " + " | ".join(titles) + " |")
    print("|" + "---|" * len(titles))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name in NAMES:
            condition = next(c for c in ALL if c.name == name)
            rows = []
            for seed in range(arguments.seeds):
                log = folder / "log.pcapng"
                truth = scan.generate(condition.setups(seed)[0], log)
                cloud = folder / "cloud.csv"
                row = compare.measure(arguments.program, log, cloud, [truth])
                rows.append((row["rms_deg"], row["worst_deg"], *bound(truth)))
            rms, worst, least, greatest = np.array(rows).T
            cells = [np.sqrt(np.mean(x**2)) for x in (rms, least)]
            cells += [worst.max(), 3 * greatest.max()]
            print("| " + " | ".join([name, *(f"{c:.5f}" for c in cells)]) + " |", flush=True)


if __name__ == "__main__":
    main()
