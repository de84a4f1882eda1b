#!/usr/bin/env python3
"""Generates scans, replays them with a program and measures its clouds against the truth.

    run.py --program PATH [--only TEXT] [--seeds N] [--json FILE] [--against FILE] [--keep FOLDER]
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import numpy as np

import compare
import drive
import scan
from conditions import ALL
from mechanism import COUNT_DEG


def number(value, digits=4, scale=1.0):
    if value is None:
        return "-"
    return f"{value * scale:.{digits}f}"


def largest(rows, name):
    values = [r[name] for r in rows if r.get(name) is not None]
    return max(values) if values else None


RATIOS = ("angle_ratio", "clock_ratio", "total_ratio", "tolerance_ratio")
# Type of an enhanced packet block of pcapng.
RECORD = 6
GOOD_DEG = 0.0109
QUIET_US = 100.0


def verdict(row):
    """The report of the program against the truth.

    SILENT: exit 0, no warning, and an error beyond its bound. unsaid: the same within the bound,
    but well above what the samples allow. wrong, poor: the same two with a message. ALARM: a
    warning about a plain scan. LOST: fewer points than the recording allows. DOUBLED: points twice.
    UNFOUNDED: points of a sweep without polls. MISBLAMED: a step of a clock that was not set so.
    ABSURD: a bound above 90 deg. refused: several logs in one file, or a clock set by hours, and
    no cloud.
    """
    beyond = any((row.get(name) or 0.0) > 1.0 for name in RATIOS)
    beyond |= bool(row.get("unmatched"))
    has_message = row["exit"] != 0 or bool(row["warnings"])
    if row["exit"] not in (0, 3, 6):
        return "FAILED"
    if (row.get("angle_bound_deg") or 0.0) > 90.0:
        return "ABSURD"
    if row.get("misblamed"):
        return "MISBLAMED"
    if beyond:
        return "wrong" if has_message else "SILENT"
    if row["exit"] == 3 and row["refusable"]:
        return "refused"
    possible = max(GOOD_DEG, 1.5 * (row.get("possible_deg") or 0.0))
    poor = (row.get("worst_deg") or 0.0) > possible
    poor |= row.get("quiet") and (row.get("clock_worst_us") or 0.0) > QUIET_US
    if row["kept"] < row["share"]:
        return "LOST"
    if row["kept"] > row["most"]:
        return "DOUBLED" if row["kept"] > 1.0 else "UNFOUNDED"
    if row["group"] == "plain" and has_message:
        return "ALARM"
    if poor:
        return "poor" if has_message else "unsaid"
    return "ok"


# Reported steps agree with true ones to this, or to a share of them.
STEP_S = 0.5e-3
STEP_SHARE = 0.3


def misblamed(sync, truths):
    """The reported steps that no clock made, each with the clock that is blamed for it.

    Steps of one clock within a tenth of a second may be reported as one.
    """
    out = []
    for step in (sync or {}).get("steps", []):
        true = []
        for truth in truths:
            setup = truth.setup
            made = {"host": setup.host_steps, "lidar": setup.lidar_steps}[step["clock"]]
            for i, (when, by) in enumerate(made):
                true += [by, sum(b for w, b in made[i:] if w - when < 0.1)]
        by = step["by_s"]
        if not any(abs(by - t) <= max(STEP_S, STEP_SHARE * abs(t)) for t in true):
            out.append([step["clock"], by])
    return out


HEADER = (
    "condition", "exit", "kept %", "worst deg", "RMS deg", "spline by hindsight", "angle bound",
    "truth/bound", "clock us", "clock bound", "truth/bound", "point mm", "method", "verdict",
)


def counted(names, all_of_them):
    return " ".join(k if v == all_of_them else f"{k} {v}" for k, v in names.most_common())


def line(name, rows):
    exits = "/".join(str(e) for e in sorted({r["exit"] for r in rows}))
    methods = Counter((r["sync"] or {}).get("angle_method", "-") for r in rows)
    verdicts = Counter(r["verdict"] for r in rows)

    return [
        name,
        exits,
        number(min(r["kept"] for r in rows), 1, 100),
        number(largest(rows, "worst_deg")),
        number(largest(rows, "rms_deg")),
        number(largest(rows, "possible_deg")),
        number(largest(rows, "angle_bound_deg")),
        number(largest(rows, "angle_ratio"), 2),
        number(largest(rows, "clock_worst_us"), 1),
        number(largest(rows, "clock_bound_us"), 1),
        number(largest(rows, "clock_ratio"), 2),
        number(largest(rows, "point_worst_mm"), 1),
        counted(methods, len(rows)),
        counted(verdicts, len(rows)),
    ]


def changes(before, after):
    """The same conditions and seeds by two programs: verdicts, worst errors, bounds."""
    old = {(r["condition"], r["seed"]): r for r in before}
    pairs = [(old[key], r) for r in after if (key := (r["condition"], r["seed"])) in old]
    lines = [
        "| condition | verdict before | after | worst deg before | after "
        "| angle's truth/bound before | after | clock us before | after | kept % before | after |",
        "|" + "---|" * 11,
    ]
    for name in dict.fromkeys(r["condition"] for _, r in pairs):
        sides = [[p[i] for p in pairs if p[1]["condition"] == name] for i in (0, 1)]
        cells = [name, *(counted(Counter(r["verdict"] for r in s), len(s)) for s in sides)]
        for column, digits in (("worst_deg", 4), ("angle_ratio", 2), ("clock_worst_us", 1)):
            cells += [number(largest(s, column), digits) for s in sides]
        cells += [number(min(r["kept"] for r in s), 1, 100) for s in sides]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def live_table(results):
    """The live view against the cloud that replaces it: the worst of each condition."""
    lines = [
        "| condition | live RMS mm | worst mm | points, % of the cloud's | lag ms |",
        "|" + "---|" * 5,
    ]
    for name in dict.fromkeys(r["condition"] for r in results):
        rows = [r for r in results if r["condition"] == name and r.get("live") and r["points"]]
        if not rows:
            continue
        live = [r["live"] for r in rows]
        cells = [
            name,
            *(number(largest(live, key), 1, 1e3) for key in ("rms_m", "worst_m")),
            number(min(r["live"]["points"] / r["points"] for r in rows), 1, 100),
            number(largest(live, "lag_s"), 0, 1e3),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


EDGES = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, float("inf"))


def summary(results):
    """Histograms of truth over bound, and how much wider the bounds are than the truth."""
    labels = [f"to {b:g}" if b < 100 else "above" for b in EDGES[1:]]
    titles = (
        "truth/bound", "scans", *labels, "median bound/truth, truths of 0 left out",
        "median with the step in both, all scans",
    )  # fmt: skip
    lines = ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    for title, name, truth, bound, step in (
        ("angle", "angle_ratio", "curve_worst_deg", "angle_bound_deg", COUNT_DEG),
        ("clock", "clock_ratio", "clock_worst_us", "clock_bound_us", 1.0),
        ("both", "total_ratio", None, None, None),
    ):
        ratios = [r[name] for r in results if r.get(name) is not None]
        if not ratios:
            continue
        counts, _ = np.histogram(ratios, bins=EDGES)
        tight = [1.0 / r for r in ratios if r]
        middle = f"{np.median(tight):.1f}" if tight else "-"
        pairs = [(r[truth], r[bound]) for r in results if r.get(truth) and r.get(bound)]
        whole = [(allowed + step) / was for was, allowed in pairs]
        whole = f"{np.median(whole):.1f}" if whole else "-"
        cells = (title, len(ratios), *counts, middle, whole)
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    verdicts = Counter(r["verdict"] for r in results)
    lines.append("\n" + ", ".join(f"{k}: {v}" for k, v in verdicts.most_common()))
    return "\n".join(lines)


def without_header(content):
    """The records of a log, to be read by another's section and interfaces."""
    at = 0
    while int.from_bytes(content[at : at + 4], "little") != RECORD:
        at += int.from_bytes(content[at + 4 : at + 8], "little")
    return content[at:]


def log_of(condition, seed, folder):
    """The log of a condition and the truths of its parts."""
    parts, truths = [], []
    for i, setup in enumerate(condition.setups(seed)):
        path = folder / f"part-{i}.pcapng"
        truths.append(scan.generate(setup, path))
        parts.append(path)
    whole = folder / "log.pcapng"
    if condition.join == "mergecap":
        whole.unlink(missing_ok=True)
        subprocess.run(["mergecap", "-w", whole, *parts], check=True)
    else:
        times = 2 if condition.join == "cat twice" else 1
        contents = [p.read_bytes() for p in parts * times]
        if condition.join == "cut, cat":
            contents[0] = contents[0][: len(contents[0]) * 7 // 10 + 5]
        if condition.join == "merged":
            contents[1:] = [without_header(content) for content in contents[1:]]
        whole.write_bytes(b"".join(contents))
    if condition.join == "cut":
        os.truncate(whole, whole.stat().st_size * 7 // 10 + 5)
    return whole, truths


GROUPS = {c.group for c in ALL}


def is_wanted(text, condition):
    """Whether `text` is the condition's group; a text that is no group is a part of its name."""
    return text == condition.group or text not in GROUPS and text in condition.name


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--only", action="append", help="a group, or conditions with this text")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--tolerance", help="LENGTH@DISTANCE, such as 3mm@20m, for the program")
    parser.add_argument("--live", action="store_true", help="compare the live view, too")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--against", type=Path, help="earlier result of --json to compare with")
    parser.add_argument("--keep", type=Path, help="keeps each log here")
    arguments = parser.parse_args()
    drive.check_frames()
    chosen = [
        c
        for c in ALL
        if not arguments.only or any(is_wanted(o, c) for o in arguments.only)
    ]
    if not chosen:
        parser.error("no such condition; they are: " + "; ".join(c.name for c in ALL))
    print("| " + " | ".join(HEADER) + " |")
    print("|" + "---|" * len(HEADER), flush=True)
    results, failed = [], False
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for condition in chosen:
            rows = []
            for seed in range(arguments.first_seed, arguments.first_seed + arguments.seeds):
                log, truths = log_of(condition, seed, folder)
                if arguments.keep:
                    arguments.keep.mkdir(parents=True, exist_ok=True)
                    name = "".join(x if x.isalnum() or x in ".+-" else "-" for x in condition.name)
                    (arguments.keep / f"{name}-{seed}.pcapng").write_bytes(log.read_bytes())
                cloud = folder / "cloud.csv"
                cloud.unlink(missing_ok=True)
                row = compare.measure(
                    arguments.program, log, cloud, truths, arguments.tolerance, arguments.live
                )
                row.update(condition=condition.name, group=condition.group, seed=seed)
                row["share"], row["most"] = condition.share, condition.most
                row["refusable"] = len(truths) > 1 or condition.hours
                row["misblamed"] = misblamed(row["sync"], truths)
                row["quiet"] = all(t.setup.network != "busy" for t in truths)
                row["verdict"] = verdict(row)
                failed |= row["verdict"].isupper() or row["verdict"] == "unsaid"
                rows.append(row)
            results.extend(rows)
            print("| " + " | ".join(line(condition.name, rows)) + " |", flush=True)
    print("\n" + summary(results))
    if arguments.live:
        print("\n" + live_table(results))
    if arguments.against:
        print("\n" + changes(json.loads(arguments.against.read_text()), results))
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
