"""open3d's RaycastingScene: waits for "box" or "mesh", casts all rays on one thread, answers how long that took.

usage: open3d_worker.py FOLDER
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
import open3d as o3d

TURN_S = 0.3


def main():
    folder = Path(sys.argv[1])

    def read(name, width):
        return np.fromfile(folder / name).reshape(-1, width)

    rays = o3d.core.Tensor(read("rays.f64", 6).astype(np.float32))
    scenes, agreement = {}, {}
    for name in ("box", "mesh"):
        scene = o3d.t.geometry.RaycastingScene(nthreads=1)
        vertices = o3d.core.Tensor(read(f"{name}.vertices.f64", 3).astype(np.float32))
        scene.add_triangles(vertices, o3d.core.Tensor(read(f"{name}.triangles.f64", 3).astype(np.uint32)))
        ranges = scene.cast_rays(rays, nthreads=1)["t_hit"].numpy()
        apart = np.abs(ranges - read(f"{name}.ranges.f64", 1)[:, 0])
        agreement[name] = {"median_m": float(np.median(apart)), "over_1e-5_m": int((apart > 1e-5).sum())}
        scenes[name] = scene
    print(json.dumps({"agreement": agreement}), flush=True)
    for line in sys.stdin:
        scene, count = scenes[line.split()[0]], 0
        cpu, wall = time.process_time(), time.perf_counter()
        while time.perf_counter() - wall < TURN_S:
            scene.cast_rays(rays, nthreads=1)
            count += rays.shape[0]
        print(json.dumps({"rays": count, "seconds": time.process_time() - cpu, "wall_s": time.perf_counter() - wall}), flush=True)


main()
