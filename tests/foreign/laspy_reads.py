"""laspy reads a .las or .laz cloud: count, bounds and dimensions as JSON.

usage: laspy_reads.py CLOUD.laz
"""

import json
import sys

import laspy
import numpy as np

with laspy.open(sys.argv[1]) as reader:
    las = reader.read()
xyz = np.vstack([las.x, las.y, las.z])
print(
    json.dumps(
        {
            "points": int(las.header.point_count),
            "min": xyz.min(axis=1).tolist(),
            "max": xyz.max(axis=1).tolist(),
            "header_min": list(las.header.mins),
            "header_max": list(las.header.maxs),
            "scales": list(las.header.scales),
            "crs_records": [v.record_id for v in las.header.vlrs if v.user_id == "LASF_Projection"],
            "dimensions": list(las.point_format.dimension_names),
            "returns": [
                [int(number), int(of), int(count)]
                for (number, of), count in zip(
                    *np.unique(np.vstack([las.return_number, las.number_of_returns]).T, axis=0, return_counts=True)
                )
            ],
            "system_identifier": las.header.system_identifier,
        }
    )
)
