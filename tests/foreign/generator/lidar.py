"""A VLP-16 on the platform: firing times, azimuths, ranges, packets. Written from its manual."""

import struct

import numpy as np

import scene

LASER_S = 2.304e-6
SEQUENCE_S = 55.296e-6
PACKET_S = 24 * SEQUENCE_S
ELEVATION_DEG = np.array([-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15.0])
ORIGIN_M = 1e-3 * np.array(
    [11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1, 5.1, -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2]
)
RING = np.argsort(np.argsort(ELEVATION_DEG))
DATA_PORT = 2368
POSITION_PORT = 8308
HOUR_US = 3_600_000_000


class Packets:
    """All packets of a scan with the truth of each shot that returns.

    `payloads`, `sent`: per packet, the bytes and the true time at which the last shot is over.
    `number`, `channel`, `times`, `points`: per shot, in the order of firing. `number` counts the
    sequences of 16 shots, `sequences` in all.
    """


def fire(clock, start, stop, tilt, mount_m, rng, head_rpm=600.0, share=8):
    """Fires from `start` to `stop` (true seconds).

    The oscillator of `clock` sets the cadence; its steps change stamps only. One shot in `share`
    returns (1, 2, 4 or 8); the others meet a surface that absorbs them. Reflectivity carries the
    number of the sequence modulo 256, so that points are recognised.
    """
    first = clock.continuous(start)
    packets = int((clock.continuous(stop) - first) / PACKET_S)
    out = Packets()
    out.sequences = packets * 24
    every = np.arange(out.sequences)[:, None]
    lasers = np.arange(16)[None, :]
    out.number, out.channel = np.nonzero((lasers + lasers // 8 + every) % 8 < 8 // share)
    out.times = clock.true_time(first + out.number * SEQUENCE_S + out.channel * LASER_S)
    blocks = clock.true_time(first + np.arange(packets * 12) * (2 * SEQUENCE_S))

    spin_phase = rng.uniform(0.0, 360.0)

    def azimuth(t):
        """An even rate with a wobble of 2 arc minutes."""
        return spin_phase + head_rpm * 6.0 * t + 2.0 / 60 * np.sin(2 * np.pi * 0.7 * t)

    angle = np.radians(azimuth(out.times))
    elevation = np.radians(ELEVATION_DEG)[out.channel]
    gamma = np.radians(tilt(out.times))

    def rotate(x, y, z):
        c, s = np.cos(gamma), np.sin(gamma)
        return np.stack([x * c + z * s, np.broadcast_to(y, x.shape), z * c - x * s], axis=-1)

    level = np.cos(elevation)
    nowhere = np.zeros(len(angle))
    origin = rotate(nowhere, 0.0, ORIGIN_M[out.channel] + mount_m)
    direction = rotate(level * np.sin(angle), level * np.cos(angle), np.sin(elevation))
    ranges = scene.distances(origin, direction)
    out.points = origin + ranges[:, None] * direction

    wire = np.zeros((packets, 12, 100), dtype=np.uint8)
    wire[:, :, 0], wire[:, :, 1] = 0xFF, 0xEE
    hundredths = np.round(azimuth(blocks) * 100).astype(np.int64) % 36000
    hundredths = hundredths.reshape(packets, 12)
    wire[:, :, 2], wire[:, :, 3] = hundredths & 0xFF, hundredths >> 8
    steps = np.round(ranges / 0.002).astype(np.int64)
    shots = np.zeros((out.sequences, 16, 3), dtype=np.uint8)
    shots[out.number, out.channel, 0] = steps & 0xFF
    shots[out.number, out.channel, 1] = steps >> 8
    shots[out.number, out.channel, 2] = out.number % 256
    wire[:, :, 4:] = shots.reshape(packets, 12, 96)

    begins = blocks[::12]
    stamp_us = stamps(clock, begins)
    out.payloads = [
        wire[i].tobytes() + struct.pack("<I", stamp_us[i]) + b"\x37\x22" for i in range(packets)
    ]
    out.sent = clock.true_time(clock.continuous(begins) + PACKET_S)
    return out


def stamps(clock, t):
    """What the lidar writes as time: whole microseconds of the hour."""
    us = np.floor((clock.reading(t) + clock.offset) * 1e6).astype(np.int64)
    return (us % HOUR_US).tolist()


def position_payload(stamp_us, pps):
    payload = bytearray(512)
    struct.pack_into("<IB", payload, 198, stamp_us, pps)
    return bytes(payload)
