"""An EPOS2 on USB and the host that polls it, as records of a log.

Written from the drive's Communication Guide: frames, checksums, objects.
"""

import struct

import numpy as np

import mechanism
from log import INBOUND, OUTBOUND

NODE = 1
HOST_TIMEOUT_S = 40e-3


def crc(words):
    """CRC-16/XMODEM, high byte of each word first."""
    value = 0
    for word in words:
        for byte in (word >> 8, word & 0xFF):
            value ^= byte << 8
            for _ in range(8):
                value = (value << 1) ^ 0x1021 if value & 0x8000 else value << 1
                value &= 0xFFFF
    return value


def usb_frame(opcode, data):
    words = struct.unpack("<%dH" % (len(data) // 2), data)
    check = crc((len(words) << 8 | opcode,) + words)
    body = bytes([opcode, len(words)]) + data + struct.pack("<H", check)
    return b"\x90\x02" + body.replace(b"\x90", b"\x90\x90")


def read_request(index, sub):
    return 0x10, struct.pack("<HBB", index, sub, NODE)


def write_request(index, sub, value):
    return 0x11, struct.pack("<HBBi", index, sub, NODE, value)


def read_answer(value, junk, small):
    """An answer; objects of 16 bits leave junk in the upper half, as the real drive does."""
    low = struct.pack("<i", value)
    return 0x00, bytes(4) + (low[:2] + struct.pack("<H", junk) if small else low)


WRITE_DONE = (0x00, bytes(4))


class Link:
    """Delays of one direction each, and the time the drive needs to answer."""

    def __init__(self, out, back, period, host_jitter=50e-6, work=80e-6, back_grid=0.0):
        self.out, self.back, self.period = out, back, period
        self.host_jitter, self.work, self.back_grid = host_jitter, work, back_grid


class Exchange:
    """One request with its answer: true times of sending, of sampling and of receipt."""

    def __init__(self, sent, taken, received, request, answer, kind, value=None):
        self.sent, self.taken, self.received = sent, taken, received
        self.request, self.answer, self.kind = request, answer, kind
        self.value = value


class Host:
    """The program that talks to the drive: one request at a time."""

    def __init__(self, link, tilt, rng, latch_s=0.0, latch_phase=0.0, encoder_phase=0.0):
        self.link, self.tilt, self.rng = link, tilt, rng
        self.latch_s, self.latch_phase = latch_s, latch_phase
        self.encoder_phase = encoder_phase
        self.exchanges = []
        self.stall = self.late = None
        self.status_s = 20e-3
        self.now = 0.0
        self.bus = 0.0

    def position(self, t):
        if self.latch_s:
            ticks = np.floor((t - self.latch_phase) / self.latch_s)
            t = ticks * self.latch_s + self.latch_phase
        return int(mechanism.counts(self.tilt(t), self.encoder_phase))

    def _travel(self):
        sent = self.now
        arrived = sent + float(self.link.out.draw(self.rng, 1)[0])
        taken = arrived + self.link.work * self.rng.uniform(0.2, 0.8)
        received = arrived + self.link.work + float(self.link.back.draw(self.rng, 1)[0])
        if self.link.back_grid:
            grid = self.link.back_grid
            received = np.ceil((received - self.bus) / grid) * grid + self.bus
        for begin, seconds in filter(None, (self.stall, self.late)):
            if begin <= sent < begin + seconds:
                self.now = sent + HOST_TIMEOUT_S
                return sent, taken, begin + seconds + 1e-3 if self.late else None
        self.now = received
        return sent, taken, received

    def _idle(self):
        self.now += 3e-6 + self.rng.exponential(8e-6)

    def read(self, index, sub=0, value=None, small=False):
        sent, taken, received = self._travel()
        kind = "read %04X" % index
        if index == 0x6064:
            value = self.position(taken)
        answer = read_answer(value, int(self.rng.integers(65536)), small)
        self.exchanges.append(
            Exchange(sent, taken, received, read_request(index, sub), answer, kind, value)
        )
        self._idle()
        return value

    def write(self, index, value, sub=0):
        sent, taken, received = self._travel()
        self.exchanges.append(
            Exchange(
                sent, taken, received, write_request(index, sub, value), WRITE_DONE,
                "write %04X" % index,
            )
        )
        self._idle()
        return taken

    def poll_until(self, end, status):
        """Reads the position once per period, the statusword every 20 ms."""
        due = self.now
        next_status = self.now + self.status_s
        while self.now < end:
            self.now = max(self.now, due + self.rng.exponential(self.link.host_jitter))
            self.read(0x6064)
            if self.now >= next_status:
                self.read(0x6041, value=status(self.now), small=True)
                next_status = self.now + self.status_s
            due = max(due + self.link.period, self.now - self.link.period)


def records(exchanges, host_ns, frame=usb_frame):
    out = []
    for e in exchanges:
        out.append((e.sent, 1, host_ns(e.sent), frame(*e.request), OUTBOUND))
        if e.received is not None:
            out.append((e.received, 1, host_ns(e.received), frame(*e.answer), INBOUND))
    return out


def check_frames():
    """Frames that the guide and a real unit show."""
    known = [
        (usb_frame(*read_request(0x6041, 0)), "9002100241600001 64CF"),
        (usb_frame(*read_request(0x6064, 0)), "9002100264600001 52A2"),
        (usb_frame(*write_request(0x6040, 0, 15)), "9002110440600001 0F000000 2D2C"),
        (usb_frame(*WRITE_DONE), "9002000200000000 408B"),
        (usb_frame(0, bytes.fromhex("0000000000009080")), "90020004 00000000 0000909080 1435"),
    ]
    for made, expected in known:
        if made != bytes.fromhex(expected):
            raise AssertionError(f"frame {made.hex()} instead of {expected}")
