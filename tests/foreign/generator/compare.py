"""Runs a program on a log and holds its cloud against the truth."""

import json
import subprocess
import time

import numpy as np

import lidar
from possible import best_spline
from mechanism import COUNT_DEG
from scan import EPOCH_NS


class Cloud:
    """Rows of the program's cloud. Times are seconds since EPOCH_NS, exact to the nanosecond."""


def read_csv(path):
    with open(path) as file:
        lines = [line for line in file if line[0] != "#"]
    names = lines[0].strip().split(",")
    when = names.index("time_s")
    rows = np.loadtxt(lines[1:], delimiter=",", ndmin=2) if len(lines) > 1 else np.zeros((0, 0))
    # A float64 of Unix seconds has steps of 0.24 us.
    stamps = [line.split(",", when + 1)[when].split(".") for line in lines[1:]]
    times = [int(whole) * 1_000_000_000 + int(part) for whole, part in stamps]
    if any(len(part) != 9 for _, part in stamps):
        raise ValueError(f"{path}: times without nanoseconds")
    out = Cloud()
    columns = {name: rows[:, i] for i, name in enumerate(names)} if len(rows) else {}
    empty = np.zeros(0)
    out.time = (np.array(times, dtype=np.int64) - EPOCH_NS) / 1e9
    out.tilt = columns.get("tilt_deg", empty)
    out.ring = columns.get("ring", empty).astype(int)
    out.code = columns.get("intensity", empty).astype(int)
    out.points = np.stack([columns.get(n, empty) for n in ("x_m", "y_m", "z_m")], axis=-1)
    return out


def match(cloud, truths, stepped):
    """Index of the truth and of the shot for each row; -1 where none fits.

    A shot is known by ring and reflectivity, which repeats after 14 ms, and by its coordinate along
    the tilt axis, which the tilt does not change. `stepped`: the program's times include the steps
    of the host's clock, instead of going on as before them.
    """
    which = np.full(len(cloud.time), -1)
    shot = np.full(len(cloud.time), -1)
    best = np.full(len(cloud.time), np.inf)
    channel = np.argsort(lidar.RING)[cloud.ring] if len(cloud.ring) else cloud.ring
    for k, truth in enumerate(truths):
        table = np.full((truth.sequences, 16), -1)
        table[truth.number, truth.channel] = np.arange(len(truth.t))
        times = truth.host + stepped * truth.host_step
        # Where the clock was set back two shots have one time; the newer is looked for first.
        order = np.argsort(times, kind="stable")
        near = np.searchsorted(times[order], cloud.time)
        rough = truth.number[order[np.clip(near, 0, len(times) - 1)]].astype(float)
        for _ in range(2):
            number = np.round((rough - cloud.code) / 256).astype(int) * 256 + cloud.code
            ok = (number >= 0) & (number < truth.sequences)
            found = np.where(ok, table[np.where(ok, number, 0), channel], -1)
            have = found >= 0
            # The cadence is the lidar's: correct the host's rate against it and look again.
            late = np.where(have, cloud.time - times[np.maximum(found, 0)], 0.0)
            rough = number + late / lidar.SEQUENCE_S
        index = np.maximum(found, 0)
        along = np.abs(cloud.points[:, 1] - truth.points[index, 1])
        good = have & (along < 0.02) & (np.abs(late) < best)
        which[good], shot[good], best[good] = k, found[good], np.abs(late)[good]
    return which, shot


def bound(report, *names):
    sync = report.get("sync") or {}
    for name in names:
        if sync.get(name) is not None:
            return float(sync[name])
    return None


def worst(values):
    return float(np.max(np.abs(values))) if len(values) else None


def rms(values):
    return float(np.sqrt(np.mean(values**2))) if len(values) else None


def run(program, log, cloud, options=()):
    command = [program, "replay", str(log), "--json", "--force", "-o", str(cloud), *options]
    begin = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True)
    took = time.monotonic() - begin
    try:
        report = json.loads(done.stdout)
    except json.JSONDecodeError:
        report = {}
    return done.returncode, report, done.stderr, took


def measure(program, log, cloud_path, truths, tolerance=None, live=False):
    """One row of the table. `tolerance`: such as 3mm@20m, which the program shall keep."""
    options = ("--tolerance", tolerance) if tolerance else ()
    options += ("--live",) if live else ()
    code, report, messages, took = run(program, log, cloud_path, options)
    row = {
        "exit": code,
        "took_s": round(took, 3),
        "warnings": report.get("warnings", []),
        "messages": [m for m in messages.splitlines() if not m.startswith("SIMULATED")],
        "sync": report.get("sync"),
        "sweeps": report.get("sweeps"),
        "points": report.get("points", 0),
        "live": report.get("live"),
    }
    due = sum(_moving(t).sum() for t in truths)
    row["due"] = int(due)
    if not cloud_path.exists():
        row["kept"] = 0.0
        return row
    cloud = read_csv(cloud_path)
    best = None
    for stepped in (False, True) if any(t.host_step.any() for t in truths) else (False,):
        which, shot = match(cloud, truths, stepped)
        pieces = [_errors(cloud, which == k, shot, t, stepped) for k, t in enumerate(truths)]
        made = {n: np.concatenate([p[n] for p in pieces]) for n in pieces[0]}
        unmatched = int((which < 0).sum())
        rank = (unmatched, worst(made["clock"]) or 0.0)
        if best is None or rank < best:
            best, joined = rank, made
            row["unmatched"], row["stepped"] = unmatched, stepped
    row["kept"] = float(joined["moving"].sum() / due)
    row["curve_worst_deg"] = worst(joined["curve"])
    row["curve_rms_deg"] = rms(joined["curve"])
    row["clock_worst_us"] = worst(joined["clock"] * 1e6)
    total, rate = joined["total"], joined["rate"]
    delay = (total @ rate) / (rate @ rate) if len(rate) and rate @ rate > 0 else 0.0
    row["delay_us"] = float(delay * 1e6)
    rest = total - delay * rate
    row["worst_deg"], row["rms_deg"] = worst(rest), rms(rest)
    row["raw_worst_deg"] = worst(total)
    possible = [best_spline(t.samples, t.motion, t.begins, t.ends, t.breaks) for t in truths]
    row["possible_deg"] = max((p for p in possible if p is not None), default=None)
    row["point_worst_mm"] = worst(joined["point"] * 1e3)
    row["point_rms_mm"] = rms(joined["point"] * 1e3)
    known = np.abs(total - rate * joined["minimum_delay"])
    if tolerance and len(total):
        length, distance = (float(part.rstrip("m")) for part in tolerance.split("@"))
        row["tolerance_ratio"] = np.radians(known.max()) * distance * 1e3 / length
    angle, clock = bound(report, "angle_bound_deg"), bound(report, "clock_bound_us")
    row["angle_bound_deg"], row["clock_bound_us"] = angle, clock
    if angle and row["curve_worst_deg"] is not None:
        # Homing leaves up to half a count that no sample shows, an axis at rest another half.
        row["angle_ratio"] = max(0.0, row["curve_worst_deg"] - COUNT_DEG) / angle
    if clock and row["clock_worst_us"] is not None:
        # The lidar's stamps are whole microseconds.
        row["clock_ratio"] = max(0.0, row["clock_worst_us"] - 1.0) / clock
    if angle and clock and len(total):
        allowed = angle + np.abs(rate) * clock * 1e-6
        known = known - COUNT_DEG - np.abs(rate) * 1e-6
        row["total_ratio"] = float(np.max(np.maximum(0.0, known) / allowed))
    return row


def _moving(truth):
    """Shots between the begin and the end of a move."""
    moves = zip(truth.begins, truth.ends)
    return np.any([(truth.t >= begin) & (truth.t <= end) for begin, end in moves], axis=0)


def _errors(cloud, mine, shot, truth, stepped):
    index = shot[mine]
    reported = cloud.time[mine] - stepped * truth.host_step[index]
    tilt = cloud.tilt[mine]
    t = truth.t[index]
    return {
        "moving": _moving(truth)[index],
        # The curve at the time that the program gives: nothing of the lidar's clock is in it.
        "curve": tilt - truth.motion(truth.true_time(reported)),
        "clock": reported - truth.host[index] - truth.minimum_delay,
        "total": tilt - truth.tilt[index],
        "rate": truth.motion.rate(t),
        "minimum_delay": np.full(len(t), truth.minimum_delay),
        "point": np.linalg.norm(cloud.points[mine] - truth.points[index], axis=1),
    }
