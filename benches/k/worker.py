"""Runs a peer: NAME FRAMES SLOP. Prints its CPU seconds, the largest error of its D, and lost pairs, as JSON."""

import json
import sys
import time

import numpy as np

BINS = 151


def rmbl(frames):
    """A VLP-16 at 901 azimuths, rotated in steps from 0 to 180 degrees (Eq. 1-6 of the paper, d = 0)."""
    azimuth = np.radians(np.arange(901) * 0.4)[:, None]
    elevation = np.radians(np.arange(16) * 2.0 - 15.0)[None, :]
    x, y = np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth)
    z = np.broadcast_to(np.sin(elevation), x.shape)
    tilts = np.radians(np.arange(frames) * 180.0 / frames)
    turned = [np.stack([x * np.cos(g) + z * np.sin(g), y, z * np.cos(g) - x * np.sin(g)], -1) for g in tilts]
    return np.concatenate([frame.reshape(-1, 3) for frame in turned])


def by_numpy(points):
    """Pairs up to every edge, in blocks of rows."""
    counts = np.zeros(BINS, dtype=np.int64)
    edges = np.cos(np.arange(BINS, -1, -1) * np.pi / BINS)
    edges[0], edges[-1] = -2.0, 2.0
    for start in range(0, len(points), 256):
        rows = points[start : start + 256]
        dots = rows @ points[start:].T
        keep = np.arange(dots.shape[1])[None, :] > np.arange(len(rows))[:, None]
        counts += np.histogram(dots[keep], edges)[0][::-1]
    return counts


def by_treecorr(points, slop):
    import treecorr

    ra, dec = np.arctan2(points[:, 1], points[:, 0]), np.arcsin(np.clip(points[:, 2], -1, 1))
    catalogue = treecorr.Catalog(ra=ra, dec=dec, ra_units="rad", dec_units="rad")
    pairs = treecorr.NNCorrelation(
        min_sep=0.0, max_sep=np.pi, nbins=BINS, bin_type="Linear", metric="Arc", sep_units="rad", bin_slop=slop, num_threads=1
    )
    pairs.process(catalogue)
    # Within one catalogue every pair is counted once.
    return np.asarray(pairs.npairs)


def by_corrfunc(points):
    from Corrfunc.mocks.DDtheta_mocks import DDtheta_mocks

    ra, dec = np.degrees(np.arctan2(points[:, 1], points[:, 0])) % 360, np.degrees(np.arcsin(np.clip(points[:, 2], -1, 1)))
    edges = np.linspace(0.0, 180.0, BINS + 1)
    pairs = DDtheta_mocks(True, 1, edges, ra, dec)
    return np.array([row["npairs"] for row in pairs]) / 2


def main():
    name, frames, slop = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
    points = rmbl(frames)
    who = {"numpy": "numpy, blocks", "treecorr": f"TreeCorr, bin_slop {slop:g}", "corrfunc": "Corrfunc, DDtheta"}[name]
    start = time.process_time()
    try:
        counts = {"numpy": by_numpy, "treecorr": lambda p: by_treecorr(p, slop), "corrfunc": by_corrfunc}[name](points)
    except ImportError as error:
        print(json.dumps({"who": who, "text": f"not installed ({error.name})"}))
        return
    cpu_s = time.process_time() - start
    all_pairs = len(points) * (len(points) - 1) / 2
    answer = {"who": who, "cpu_s": cpu_s, "off": float("nan"), "lost": all_pairs - float(counts.sum())}
    if all_pairs < 2e8:
        truth = counts if name == "numpy" else by_numpy(points)
        answer["off"] = float(np.abs(np.cumsum(counts - truth)).max() / all_pairs)
    print(json.dumps(answer))


main()
