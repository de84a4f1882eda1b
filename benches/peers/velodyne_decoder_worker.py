"""velodyne-decoder's side of the benchmark: velodyne_decoder_worker.py FOLDER RECORDING MODEL

Reads a name of a measurement per line of stdin, and answers with CPU seconds, seconds, passes and points. "equality" compares its points with velomotion's
(points.bin). The package must accept RECORDING as MODEL.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
import velodyne_decoder as vd

LEAST_S = 0.1  # as in the other workers
RECORD = 8 + vd.PACKET_SIZE

folder, recording, model_name = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
MODELS = {
    "VLP-16": vd.Model.VLP16,
    "Puck Hi-Res": vd.Model.PuckHiRes,
    "HDL-32E": vd.Model.HDL32E,
    "VLP-32C": vd.Model.VLP32C,
}
# No points are omitted by range, as in velomotion.
config = vd.Config(model=MODELS[model_name], min_range=0.0, max_range=1000.0)
product = {"VLP-16": 0x22, "Puck Hi-Res": 0x24, "HDL-32E": 0x21, "VLP-32C": 0x28}[model_name]

INFO = json.loads((folder / "info.json").read_text())
DUAL = INFO["return_mode"] == 0x39


def packets():
    raw = (folder / "packets.bin").read_bytes()
    for at in range(0, len(raw), RECORD):
        nanoseconds = int.from_bytes(raw[at : at + 8], "little", signed=True)
        # The package refuses packets with the factory byte of another model.
        payload = raw[at + 8 : at + RECORD - 1] + bytes([product])
        yield vd.VelodynePacket(nanoseconds * 1e-9, payload), payload


def revolutions():
    """The packets of each revolution, cut as its own stream decoder does, but converted beforehand."""
    scans, scan, turned, last = [], [], 0, None
    for packet, payload in packets():
        azimuth = int.from_bytes(payload[2:4], "little")
        if last is not None:
            turned += (azimuth - last) % 36000
        if turned >= 36000:
            scans.append(vd.PacketVector(scan))
            scan, turned = [], 0
        scan.append(packet)
        last = azimuth
    return scans + [vd.PacketVector(scan)]


SCANS = revolutions()
DECODER = vd.ScanDecoder(config)


def per_revolution(structs):
    points = 0
    for scan in SCANS:
        points += len(DECODER.decode(scan, structs)[1])
    return points


def per_revolution_kept(structs):
    return sum(map(len, [DECODER.decode(scan, structs)[1] for scan in SCANS]))


def from_file(structs):
    points = 0
    for _, cloud in vd.read_pcap(recording, config, structs):
        points += len(cloud)
    return points


WORK = {
    "handed on, floats": lambda: per_revolution(False),
    "handed on, structs": lambda: per_revolution(True),
    "kept, structs": lambda: per_revolution_kept(True),
    "file, floats": lambda: from_file(False),
    "file, structs": lambda: from_file(True),
}

OURS = np.dtype(
    [("xyz", "<f8", 3), ("time", "<f8"), ("firing", "<u4"), ("ring", "u1"), ("intensity", "u1"), ("laser", "u1"), ("", "V1")]
)
# Firings a block, microseconds a firing and a laser, lasers at once (the models' manuals).
TIMING = {
    "VLP-16": (2, 55.296, 2.304, 1),
    "Puck Hi-Res": (2, 55.296, 2.304, 1),
    "HDL-32E": (1, 46.08, 1.152, 1),
    "VLP-32C": (1, 55.296, 2.304, 2),
}


def theirs_by_packet():
    """The points of each packet, so that packet, firing, ring and distance identify a point. The result is compared with
    read_pcap."""
    clouds, numbers, blocks = [], [], []
    for number, (packet, payload) in enumerate(packets()):
        cloud = DECODER.decode(vd.PacketVector([packet]), True)[1]
        clouds.append(cloud)
        numbers.append(np.full(len(cloud), number))
        # Both blocks of a dual pair have the same azimuth.
        azimuths = [payload[at + 2 : at + 4] for at in range(0, 1200, 200 if DUAL else 100)]
        blocks.append([int.from_bytes(azimuth, "little") for azimuth in azimuths])
    cloud = np.concatenate(clouds)
    whole = np.concatenate([points for _, points in vd.read_pcap(recording, config, True)])
    axes = ("x", "y", "z", "intensity", "ring")
    same = len(whole) == len(cloud) and all(np.array_equal(whole[axis], cloud[axis]) for axis in axes)
    return cloud, np.concatenate(numbers), np.array(blocks), same


def equality():
    theirs, packet, blocks, same = theirs_by_packet()
    ours = np.fromfile(folder / "points.bin", dtype=OURS)
    result = {"theirs": len(theirs), "ours": len(ours), "packet_by_packet_is_read_pcap": bool(same)}
    if len(theirs) != len(ours):
        return result
    firings = INFO["firings"] // INFO["packets"]
    # The order of the two returns of a dual pair differs.
    them = np.stack([-theirs["y"], theirs["x"], theirs["z"]], axis=1).astype(float)
    reach = np.linalg.norm(them, axis=1), np.linalg.norm(ours["xyz"], axis=1)
    order = np.lexsort((reach[0], theirs["ring"], theirs["column"], packet))
    them, theirs, packet = them[order], theirs[order], packet[order]
    ours = ours[np.lexsort((reach[1], ours["ring"], ours["firing"]))]
    us = ours["xyz"]
    result["same_rings"] = bool(np.array_equal(theirs["ring"], ours["ring"]))
    result["same_packets"] = bool(np.array_equal(packet, ours["firing"] // firings))
    result["same_intensities"] = bool(np.array_equal(theirs["intensity"].astype("u1"), ours["intensity"]))
    # Most of the difference is azimuth. Rotate velomotion's points to the other azimuths and compare again.
    angle = np.arctan2(them[:, 0], them[:, 1]) - np.arctan2(us[:, 0], us[:, 1])
    angle = (angle + np.pi) % (2 * np.pi) - np.pi
    sin, cos = np.sin(angle), np.cos(angle)
    turned = np.stack([us[:, 0] * cos + us[:, 1] * sin, us[:, 1] * cos - us[:, 0] * sin, us[:, 2]], axis=1)
    raw_mm = np.abs(them - us).max(axis=1) * 1e3
    turned_mm = np.abs(them - turned).max(axis=1) * 1e3
    # The rest may be the height at which each laser's ray starts.
    up = them[:, 2] - turned[:, 2]
    rings = ours["ring"].astype(int)
    heights = np.array([np.median(up[rings == ring]) if (rings == ring).any() else 0.0 for ring in range(32)])
    turned[:, 2] += heights[rings]
    explained_mm = np.abs(them - turned).max(axis=1) * 1e3
    degrees = np.abs(np.degrees(angle))
    steps = np.diff(blocks, axis=1) % 36000
    # A much larger step: the field of view is limited and the packet spans the gap.
    straddling = (steps.max(axis=1) > 10 * np.maximum(1, np.median(steps, axis=1)))[packet]
    # Its azimuths extrapolate the block's at the mean rate of the packet, rounded to 0.01 deg. velomotion interpolates to the next block,
    # also to that of the next packet.
    many, firing_us, laser_us, at_once = TIMING[model_name]
    in_packet = ours["firing"] % firings
    after = (in_packet % many * firing_us + ours["laser"] // at_once * laser_us) / (many * firing_us)
    rule = (blocks[packet, in_packet // many] + steps.mean(axis=1)[packet] * after) / 100
    off_rule = np.abs((np.degrees(np.arctan2(them[:, 0], them[:, 1])) - rule + 180) % 360 - 180)
    last = in_packet // many == blocks.shape[1] - 1
    kinds = {
        "blocks with a successor in their packet": ~straddling & ~last,
        "last blocks of packets": ~straddling & last,
        "packets on both sides of a gap": straddling,
    }
    result |= {"over_1_mm": int((raw_mm > 1).sum()), "max_mm": float(raw_mm.max())}
    result |= {"turned_over_1_mm": int((turned_mm > 1).sum()), "max_turned_mm": float(turned_mm.max())}
    result |= {"max_height_mm": float(np.abs(heights).max() * 1e3), "explained_over_1_mm": int((explained_mm > 1).sum())}
    result["farthest_m"] = float(np.linalg.norm(us, axis=1).max())
    result["kinds"] = {
        name: {
            "points": int(of.sum()),
            "over_1_mm": int((raw_mm[of] > 1).sum()),
            "max_mm": float(raw_mm[of].max(initial=0)),
            "max_deg": float(degrees[of].max(initial=0)),
            "max_off_rule_deg": float(off_rule[of].max(initial=0)),
            "max_turned_mm": float(turned_mm[of].max(initial=0)),
            "explained_max_mm": float(explained_mm[of].max(initial=0)),
        }
        for name, of in kinds.items()
    }
    return result


print("{}", flush=True)
for line in sys.stdin:
    name = line.rstrip("\n")
    if name == "equality":
        print(json.dumps(equality()), flush=True)
        continue
    work = WORK[name]
    work()
    passes = points = 0
    start, cpu = time.perf_counter(), time.process_time()
    while passes == 0 or time.perf_counter() - start < LEAST_S:
        points += work()
        passes += 1
    seconds, wall = time.process_time() - cpu, time.perf_counter() - start
    print(json.dumps({"seconds": seconds, "wall_s": wall, "passes": passes, "points": points}), flush=True)
