"""pye57 (libE57Format) reads the scans of an .e57 cloud and compares them with the .csv of the same log.

usage: e57_scans.py CLOUD.e57 CLOUD.csv
"""

import json
import sys

import numpy as np
import pye57

pye57.e57.SUPPORTED_POINT_FIELDS.update({"timeStamp": "d"})
file = pye57.E57(sys.argv[1])
headers = [file.get_header(index) for index in range(file.scan_count)]
scans = [file.read_scan_raw(index, ignore_unsupported_fields=True) for index in range(file.scan_count)]
xyz = [np.vstack([scan[f"cartesian{axis}"] for axis in "XYZ"]).T for scan in scans]
# GPS time began at Unix second 315,964,800, and is 18 leap seconds ahead since 2017.
starts = [header.acquisitionStart_dateTimeValue + 315_964_800 - 18 for header in headers]
times = [scan["timeStamp"] + start for scan, start in zip(scans, starts)]
with open(sys.argv[2], encoding="utf-8") as csv:
    lines = [line for line in csv if not line.startswith("#")]
names = lines[0].strip().split(",")
rows = np.loadtxt(lines[1:], delimiter=",")
csv_xyz, csv_times = rows[:, [names.index(name) for name in ("x_m", "y_m", "z_m")]], rows[:, names.index("time_s")]
print(
    json.dumps(
        {
            "names": [header["name"].value() for header in headers],
            "guids": [header["guid"].value() for header in headers],
            "points": [len(points) for points in xyz],
            "poses": [[*header.translation.tolist(), *header.rotation.tolist()] for header in headers],
            "spans_s": [[float(time.min()), float(time.max())] for time in times],
            "ends_s": [header.acquisitionEnd_dateTimeValue + 315_964_800 - 18 for header in headers],
            "max_difference_m": float(np.abs(np.concatenate(xyz) - csv_xyz).max()),
            "max_time_difference_s": float(np.abs(np.concatenate(times) - csv_times).max()),
            "rows": int(len(rows)),
        }
    )
)
