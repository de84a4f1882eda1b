"""Open3D reads a .ply or .pcd cloud: count, bounds and columns as JSON.

usage: open3d_reads.py CLOUD
"""

import json
import sys

import open3d as o3d

cloud = o3d.t.io.read_point_cloud(sys.argv[1])
xyz = cloud.point.positions.numpy()
print(
    json.dumps(
        {
            "points": int(xyz.shape[0]),
            "min": xyz.min(axis=0).tolist(),
            "max": xyz.max(axis=0).tolist(),
            "columns": sorted(name for name in cloud.point),
        }
    )
)
