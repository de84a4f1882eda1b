"""Open3D reads a .ply, .pcd or .xyz cloud, and numpy a .bin of KITTI or a .npz: count, bounds and columns as JSON.

usage: open3d_reads.py CLOUD
"""

import json
import sys
import zipfile

import numpy as np
import open3d as o3d

path = sys.argv[1]
if path.endswith(".bin"):
    rows = np.fromfile(path, dtype="<f4").reshape(-1, 4)
    assert 0 <= rows[:, 3].min() and rows[:, 3].max() <= 1, "reflectance from 0 to 1"
    # KITTI: x forward, y left. Ours: x right, y forward.
    xyz = np.column_stack([-rows[:, 1], rows[:, 0], rows[:, 2]])
    columns = ["positions", "reflectance"]
elif path.endswith(".npz"):
    assert zipfile.ZipFile(path).testzip() is None, "checksums"
    archive = np.load(path)
    points = archive["points"]
    assert b"SIMULATED" in archive["metadata.txt"]
    xyz = np.column_stack([points[axis] for axis in "xyz"])
    assert (points["time"] > 1.6e9).all() and points["ring"].max() < 16, "columns are where they should be"
    columns = sorted(name for name in points.dtype.names if name not in "xyz")
else:
    cloud = o3d.t.io.read_point_cloud(path)
    xyz = cloud.point.positions.numpy()
    columns = sorted(name for name in cloud.point)
print(
    json.dumps(
        {
            "points": int(xyz.shape[0]),
            "min": xyz.min(axis=0).tolist(),
            "max": xyz.max(axis=0).tolist(),
            "columns": columns,
        }
    )
)
