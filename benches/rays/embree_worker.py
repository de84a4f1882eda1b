"""embree by embreex: waits for "box" or "mesh", casts all rays, answers how long that took.

usage: embree_worker.py FOLDER
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

TURN_S = 0.3


def main():
    folder = Path(sys.argv[1])

    def read(name, width):
        return np.fromfile(folder / name).reshape(-1, width)

    rays = read("rays.f64", 6).astype(np.float32)
    origins, directions = np.ascontiguousarray(rays[:, :3]), np.ascontiguousarray(rays[:, 3:])
    scenes, agreement = {}, {}
    for name in ("box", "mesh"):
        scene = EmbreeScene()
        vertices = read(f"{name}.vertices.f64", 3).astype(np.float32)
        TriangleMesh(scene, vertices, read(f"{name}.triangles.f64", 3).astype(np.int32))
        ranges = scene.run(origins, directions, query="DISTANCE")
        apart = np.abs(ranges - read(f"{name}.ranges.f64", 1)[:, 0])
        agreement[name] = {"median_m": float(np.median(apart)), "over_1e-5_m": int((apart > 1e-5).sum())}
        scenes[name] = scene
    print(json.dumps({"agreement": agreement}), flush=True)
    for line in sys.stdin:
        scene, count = scenes[line.split()[0]], 0
        cpu, wall = time.process_time(), time.perf_counter()
        while time.perf_counter() - wall < TURN_S:
            scene.run(origins, directions, query="DISTANCE")
            count += len(origins)
        print(json.dumps({"rays": count, "seconds": time.process_time() - cpu, "wall_s": time.perf_counter() - wall}), flush=True)


main()
