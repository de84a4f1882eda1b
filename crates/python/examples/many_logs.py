#!/usr/bin/env python3
"""Reads many logs with Dask, and says what each costs.

usage: many_logs.py [--workers N | --scheduler ADDRESS] LOG...

Without a scheduler it starts a local cluster of processes. With one the same function runs on other machines, which
need velomotion and the files at the same paths (a shared file system).
"""

import argparse
import os
import resource
import time
import warnings
from pathlib import Path

import dask
import velomotion
from dask.distributed import Client, LocalCluster


def summarise(path):
    """Reads a log frame by frame, so that memory holds a revolution, not the log."""
    began, cpu = time.perf_counter(), time.process_time()
    points, farthest = 0, 0.0
    with warnings.catch_warnings(record=True) as missing:
        warnings.simplefilter("always", velomotion.IncompleteWarning)
        for frame in velomotion.frames(path, fields=["range"]):
            points += len(frame)
            farthest = max(farthest, float(frame["range"].max()))
    return {
        "log": Path(path).name,
        "points": points,
        "farthest_m": farthest,
        "seconds": time.perf_counter() - began,
        "cpu_s": time.process_time() - cpu,
        "megabytes": os.path.getsize(path) / 1e6,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3,
        "process": os.getpid(),
        "incomplete": len(missing) > 0,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("logs", nargs="+", metavar="LOG")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--scheduler")
    arguments = parser.parse_args()
    if arguments.scheduler:
        client = Client(arguments.scheduler)
    else:
        # One thread each: a read uses one core.
        client = Client(LocalCluster(n_workers=arguments.workers, threads_per_worker=1, processes=True, dashboard_address=None))
    with client:
        began = time.perf_counter()
        tasks = [dask.delayed(summarise)(os.path.abspath(log)) for log in arguments.logs]
        rows = dask.compute(*tasks)
        seconds = time.perf_counter() - began
    print(f"{'log':<24} {'points':>10} {'far m':>7} {'MB':>8} {'s':>7} {'CPU s':>7} {'peak MB':>8}")
    for row in rows:
        note = "  incomplete" if row["incomplete"] else ""
        print(
            f"{row['log']:<24} {row['points']:>10} {row['farthest_m']:>7.1f} {row['megabytes']:>8.1f} {row['seconds']:>7.3f} "
            f"{row['cpu_s']:>7.3f} {row['peak_mb']:>8.0f}{note}"
        )
    megabytes = sum(row["megabytes"] for row in rows)
    processes = len({row["process"] for row in rows})
    print(f"{len(rows)} logs, {megabytes:.1f} MB in {seconds:.2f} s: {megabytes / seconds:.1f} MB/s by {processes} processes")


if __name__ == "__main__":
    main()
