"""pye57 (libE57Format) reads an .e57 cloud: count, bounds and columns as JSON.

usage: e57_reads.py CLOUD.e57
"""

import json
import sys

import numpy as np
import pye57

# As users read it, with pye57 as it is.
plain = pye57.E57(sys.argv[1]).read_scan(0)
# libE57Format reads any attribute; pye57 asks for those that it knows.
pye57.e57.SUPPORTED_POINT_FIELDS.update({"timeStamp": "d", "velomotion:tilt": "d"})
file = pye57.E57(sys.argv[1])
header = file.get_header(0)
scan = file.read_scan_raw(0)
placed = file.read_scan(0, intensity=True)
assert all((plain[name] == placed[name]).all() for name in plain)
xyz = np.vstack([placed[f"cartesian{axis}"] for axis in "XYZ"])
print(
    json.dumps(
        {
            "scans": file.scan_count,
            "points": int(header.point_count),
            "read": int(xyz.shape[1]),
            "min": xyz.min(axis=1).tolist(),
            "max": xyz.max(axis=1).tolist(),
            "header_min": [header.xMinimum, header.yMinimum, header.zMinimum],
            "header_max": [header.xMaximum, header.yMaximum, header.zMaximum],
            "fields": header.point_fields,
            "intensity": [float(placed["intensity"].min()), float(placed["intensity"].max())],
            "rows": [int(scan["rowIndex"].min()), int(scan["rowIndex"].max())],
            "times_s": [float(scan["timeStamp"].min()), float(scan["timeStamp"].max())],
            "tilt_deg": [float(scan["velomotion:tilt"].min()), float(scan["velomotion:tilt"].max())],
            "pose": [*header.translation.tolist(), *header.rotation.tolist()],
            "acquired_gps_s": [header.acquisitionStart_dateTimeValue, header.acquisitionEnd_dateTimeValue],
            "description": header["description"].value(),
        }
    )
)
