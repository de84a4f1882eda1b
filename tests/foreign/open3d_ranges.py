"""open3d's RaycastingScene casts the same rays at the same mesh: how far apart are the ranges?

usage: open3d_ranges.py VERTICES TRIANGLES RAYS RANGES    (all f64, little-endian: x y z, a b c, origin and direction, range)

A ray is at a silhouette if another that passes 1 mm beside it, to any of four sides, meets something more than 10 cm away from there
or misses.
"""

import json
import sys

import numpy as np
import open3d as o3d


def main():
    vertices, triangles, rays, ours = (
        np.fromfile(path).reshape(-1, width) for path, width in zip(sys.argv[1:], (3, 3, 6, 1), strict=True)
    )
    ours = ours[:, 0]
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor(vertices.astype(np.float32)), o3d.core.Tensor(triangles.astype(np.uint32))
    )

    def cast(rays):
        return scene.cast_rays(o3d.core.Tensor(rays.astype(np.float32)))["t_hit"].numpy().astype(float)

    theirs = cast(rays)
    origin, along = rays[:, :3], rays[:, 3:]
    across = np.cross(along, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    up = np.cross(across, along)
    silhouette = np.zeros(len(rays), bool)
    for side in (across, -across, up, -up):
        beside = cast(np.hstack([origin + 1e-3 * side, along]))
        with np.errstate(invalid="ignore"):
            apart = np.abs(beside - theirs)
        silhouette |= np.where(np.isinf(beside) & np.isinf(theirs), 0.0, apart) > 0.1
    both = np.isfinite(ours) & np.isfinite(theirs)
    apart = np.where(both, np.abs(np.where(both, ours - theirs, 0.0)), np.where(np.isinf(ours) == np.isinf(theirs), 0.0, np.inf))
    away = apart > 1e-5
    print(
        json.dumps(
            {
                "rays": len(rays),
                "hits": int(both.sum()),
                "silhouette": int(silhouette.sum()),
                "apart_at_silhouettes": int((away & silhouette).sum()),
                "apart_elsewhere": int((away & ~silhouette).sum()),
                "median_m": float(np.median(apart)),
                "max_elsewhere_m": float(apart[~silhouette].max()),
            }
        )
    )


main()
