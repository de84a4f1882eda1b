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
    """All packets of a scan with the truth of each shot.

    `payloads`, `sent`: per packet, the bytes and the true time at which the last shot is over.
    `times`, `points`, `ranges`: per shot, arrays of (packets * 24, 16).
    `kept`: shots that return. The others meet a surface that absorbs them.
    """


def fire(clock, start, stop, tilt, mount_m, rng, head_rpm=600.0, share=8):
    """Fires from `start` to `stop` (true seconds).

    The oscillator of `clock` sets the cadence; its steps change stamps only. Reflectivity carries
    the number of the sequence modulo 256, so that points are recognised.
    """
    first = clock.continuous(start)
    packets = int((clock.continuous(stop) - first) / PACKET_S)
    sequence = np.arange(packets * 24)
    device = first + (sequence[:, None] * SEQUENCE_S + np.arange(16)[None, :] * LASER_S)
    times = clock.true_time(device.ravel()).reshape(device.shape)

    spin_phase = rng.uniform(0.0, 360.0)
    rate = head_rpm * 6.0
    wobble = 2.0

    def azimuth(t):
        return spin_phase + rate * t + wobble / 60 * np.sin(2 * np.pi * 0.7 * t)

    angle = np.radians(azimuth(times))
    elevation = np.radians(ELEVATION_DEG)[None, :]
    gamma = np.radians(tilt(times))
    direction = np.stack(
        np.broadcast_arrays(
            np.cos(elevation) * np.sin(angle), np.cos(elevation) * np.cos(angle), np.sin(elevation)
        ),
        axis=-1,
    )
    origin = np.zeros_like(direction)
    origin[..., 2] = ORIGIN_M[None, :] + mount_m

    def rotate(v):
        x = v[..., 0] * np.cos(gamma) + v[..., 2] * np.sin(gamma)
        z = v[..., 2] * np.cos(gamma) - v[..., 0] * np.sin(gamma)
        return np.stack([x, v[..., 1], z], axis=-1)

    o, d = rotate(origin), rotate(direction)
    channel = np.arange(16)[None, :]
    number = sequence[:, None]
    kept = (channel + channel // 8 + number) % 8 < 8 // share
    ranges = np.zeros(times.shape)
    ranges[kept] = scene.distances(o[kept], d[kept])
    out = Packets()
    out.times, out.kept, out.ranges = times, kept, ranges
    out.points = o + ranges[..., None] * d

    wire = np.zeros((packets, 12, 100), dtype=np.uint8)
    wire[:, :, 0], wire[:, :, 1] = 0xFF, 0xEE
    blocks = azimuth(times[::2, 0])
    hundredths = np.round(blocks * 100).astype(np.int64) % 36000
    hundredths = hundredths.reshape(packets, 12)
    wire[:, :, 2], wire[:, :, 3] = hundredths & 0xFF, hundredths >> 8
    steps = np.round(ranges / 0.002).astype(np.int64).reshape(packets, 12, 32)
    codes = np.broadcast_to(number % 256, times.shape).reshape(packets, 12, 32)
    shots = wire[:, :, 4:].reshape(packets, 12, 32, 3)
    shots[..., 0], shots[..., 1] = steps & 0xFF, steps >> 8
    shots[..., 2] = np.where(steps > 0, codes, 0)
    wire[:, :, 4:] = shots.reshape(packets, 12, 96)

    begins = times[::24, 0]
    out.stamp_us = stamps(clock, begins)
    out.payloads = [
        wire[i].tobytes() + struct.pack("<I", out.stamp_us[i]) + b"\x37\x22"
        for i in range(packets)
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
