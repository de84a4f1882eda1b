"""An EPOS2 and the host that talks to it, as records of a log: USB, RS232, CAN.

Written from the drive's Communication Guide and CiA 301: frames, checksums, objects.
"""

import struct

import numpy as np

import log
import mechanism
from log import INBOUND, OUTBOUND

NODE = 1
HOST_TIMEOUT_S = 40e-3
# A full CAN frame at 1 Mbit/s.
FRAME_S = 130e-6
READ, WRITE, ANSWER = 0x10, 0x11, 0x00
# Bytes of the objects, index and sub-index, that are not of 32 bits.
WIDTHS = {
    (0x6040, 0): 2,
    (0x6041, 0): 2,
    (0x6060, 0): 1,
    (0x6061, 0): 1,
    (0x1800, 2): 1,
    (0x1A00, 0): 1,
}


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


def _words(data):
    return struct.unpack("<%dH" % (len(data) // 2), data)


def usb_frame(opcode, data):
    words = _words(data)
    check = crc((len(words) << 8 | opcode,) + words)
    body = bytes([opcode, len(words)]) + data + struct.pack("<H", check)
    return b"\x90\x02" + body.replace(b"\x90", b"\x90\x90")


def rs232_frame(opcode, data):
    """The bytes after the operation code."""
    words = _words(data)
    check = crc((opcode << 8 | (len(words) - 1),) + words)
    return bytes([len(words) - 1]) + data + struct.pack("<H", check)


def can_frame(identifier, data=b""):
    return struct.pack(">IB3x", identifier, len(data)) + data.ljust(8, b"\0")


class Access:
    """A read or a write of an object."""

    def __init__(self, index, sub, value=None):
        self.index, self.sub, self.value = index, sub, value
        self.width = WIDTHS.get((index, sub), 4)

    def serial_request(self):
        head = struct.pack("<HBB", self.index, self.sub, NODE)
        if self.value is None:
            return READ, head
        return WRITE, head + struct.pack("<i", self.value)

    def serial_answer(self, value, rng):
        """Objects of 16 bits or fewer leave junk in the upper half, as the real drive does."""
        if self.value is not None:
            return ANSWER, bytes(4)
        low = struct.pack("<i", value)
        if self.width < 4:
            low = low[:2] + rng.bytes(2)
        return ANSWER, bytes(4) + low

    def can_request(self):
        width = self.width
        if self.value is None:
            data = struct.pack("<BHB4x", 0x40, self.index, self.sub)
        else:
            command = {4: 0x23, 2: 0x2B, 1: 0x2F}[width]
            value = self.value & ((1 << 8 * width) - 1)
            data = struct.pack("<BHBI", command, self.index, self.sub, value)
        return can_frame(0x600 + NODE, data)

    def can_answer(self, value):
        width = self.width
        if self.value is not None:
            data = struct.pack("<BHB4x", 0x60, self.index, self.sub)
        else:
            command = {4: 0x43, 2: 0x4B, 1: 0x4F}[width]
            masked = value & ((1 << 8 * width) - 1)
            data = struct.pack("<BHBI", command, self.index, self.sub, masked)
        return can_frame(0x580 + NODE, data)


class Usb:
    """Delays of each direction, and the time that the drive needs to answer.

    `back_grid`: the adapter delivers bytes at the end of such periods (latency timer).
    """

    name, kind, settings = "epos2-usb", log.USER0, ""

    def __init__(self, out, back, period, host_jitter=50e-6, work=80e-6, back_grid=0.0):
        self.out, self.back, self.period = out, back, period
        self.host_jitter, self.work, self.back_grid = host_jitter, work, back_grid

    def exchange(self, rng, now, access, answer):
        """Sends a request at `now`. Returns when it was executed, and the records."""
        arrived = now + float(self.out.draw(rng, 1)[0])
        taken = arrived + self.work * rng.uniform(0.2, 0.8)
        received = arrived + self.work + float(self.back.draw(rng, 1)[0])
        if self.back_grid:
            received = np.ceil(received / self.back_grid) * self.back_grid
        reply = usb_frame(*access.serial_answer(answer(taken), rng))
        return taken, [
            (now, OUTBOUND, usb_frame(*access.serial_request())),
            (received, INBOUND, reply),
        ]


class Rs232:
    """A serial line: each byte takes ten bits; the host reads `late` after the last one."""

    name, kind = "epos2-rs232", log.USER0

    def __init__(self, late, period, baud=115_200, host_jitter=50e-6, work=120e-6):
        self.late, self.period, self.baud = late, period, baud
        self.host_jitter, self.work = host_jitter, work
        self.settings = f"rs232_baud = {baud}\n"

    def exchange(self, rng, now, access, answer):
        records = []

        def send(at, data):
            records.append((at, OUTBOUND, data))
            return at + len(data) * 10 / self.baud

        def receive(at, data):
            """`at`: when the drive begins to send."""
            over = at + len(data) * 10 / self.baud + float(self.late.draw(rng, 1)[0])
            records.append((over, INBOUND, data))
            return over + 5e-6 + rng.exponential(10e-6)

        opcode, data = access.serial_request()
        turn = self.work / 4
        at = send(now, bytes([opcode]))
        at = receive(at + turn, b"O")
        at = send(at, rs232_frame(opcode, data))
        taken = at + self.work * rng.uniform(0.2, 0.8)
        at = receive(at + self.work, b"O\x00")
        at = send(at, b"O")
        _, data = access.serial_answer(answer(taken), rng)
        at = receive(at + turn, rs232_frame(ANSWER, data))
        send(at, b"O")
        return taken, records


class Can:
    """A CAN bus: positions come at each SYNC with the drive's time; the rest is SDO.

    `loss`: share of SYNCs and of process data lost between the program and the drive.
    """

    name, kind, settings = "epos2-can", log.SOCKETCAN, ""

    def __init__(self, out, back, period=1e-3, host_jitter=30e-6, work=100e-6, loss=0.0):
        self.out, self.back, self.period = out, back, period
        self.host_jitter, self.work, self.loss = host_jitter, work, loss

    def exchange(self, rng, now, access, answer):
        arrived = now + float(self.out.draw(rng, 1)[0])
        taken = arrived + self.work * rng.uniform(0.2, 0.8)
        received = arrived + self.work + float(self.back.draw(rng, 1)[0])
        return taken, [
            (now, OUTBOUND, access.can_request()),
            (received, INBOUND, access.can_answer(answer(taken))),
        ]


class Host:
    """The program that talks to the drive: one request at a time.

    `drive_us`: the drive's own clock, whole microseconds at a true time.
    """

    def __init__(self, link, tilt, rng, drive_us, encoder_phase):
        self.link, self.tilt, self.rng, self.drive_us = link, tilt, rng, drive_us
        self.encoder_phase = encoder_phase
        self.latch_s, self.latch_phase = 0.0, 0.0
        self.dither = 0
        self.stall = self.late = None
        self.status_s = 20e-3
        self.records, self.samples = [], []
        self.now = 0.0
        self._arrivals = {OUTBOUND: 0.0, INBOUND: 0.0}
        self._taken = 0.0

    def position(self, t):
        if self.latch_s:
            ticks = np.floor((t - self.latch_phase) / self.latch_s)
            t = ticks * self.latch_s + self.latch_phase
        shake = self.rng.integers(-self.dither, self.dither + 1) if self.dither else 0
        self.last = int(mechanism.counts(self.tilt(t), self.encoder_phase) + shake)
        return self.last

    def _do(self, access, answer):
        begin = self.now
        taken, records = self.link.exchange(self.rng, begin, access, answer)
        end = records[-1][0]
        lost = [w for w in (self.stall, self.late) if w and w[0] <= begin < w[0] + w[1]]
        if lost and access.index == 0x6064:
            (first, seconds), late = lost[0], lost[0] is self.late
            shift = first + seconds + 1e-3 - end
            records = [
                (t + shift * (d == INBOUND), d, data)
                for t, d, data in records
                if d == OUTBOUND or late
            ]
            end = begin + HOST_TIMEOUT_S
        elif access.index == 0x6064 and access.value is None:
            self.samples.append((begin, end, self.last * mechanism.COUNT_DEG))
        self.records += records
        self.now = end + 3e-6 + self.rng.exponential(8e-6)
        return taken

    def read(self, index, sub=0, value=None):
        self._do(Access(index, sub), self.position if index == 0x6064 else lambda _: value)

    def write(self, index, value, sub=0):
        return self._do(Access(index, sub, value), lambda _: 0)

    def prepare(self):
        """What a link needs before positions come."""
        if not isinstance(self.link, Can):
            return
        self._send(self.now, can_frame(0, bytes([0x80, NODE])))
        self.now += 200e-6
        for index, sub, value in (
            (0x1800, 1, 0xC0000180 + NODE),
            (0x1800, 2, 1),
            (0x1A00, 0, 0),
            (0x1A00, 1, 0x60640020),
            (0x1A00, 2, 0x10130020),
            (0x1A00, 0, 2),
            (0x1800, 1, 0x40000180 + NODE),
        ):
            self.write(index, value, sub)
            self.read(index, sub, value)
        self._send(self.now, can_frame(0, bytes([0x01, NODE])))
        self.now += 200e-6

    def _send(self, at, frame):
        self.records.append((at, OUTBOUND, frame))

    def poll_until(self, end, status):
        """Reads the position once per period and the statusword now and then."""
        if isinstance(self.link, Can):
            return self._sync_until(end, status)
        due = self.now
        next_status = self.now + self.status_s
        while self.now < end:
            self.now = max(self.now, due + self.rng.exponential(self.link.host_jitter))
            self.read(0x6064)
            if self.now >= next_status:
                self.read(0x6041, value=status(self.now))
                next_status = self.now + self.status_s
            due = max(due + self.link.period, self.now - self.link.period)

    def _sync_until(self, end, status):
        """SYNCs at the period; each answer has the position and the drive's time of its SYNC."""
        rng, link = self.rng, self.link
        begin = self.now
        next_status = begin + self.status_s
        for due in np.arange(begin, end, link.period):
            sent = max(due + rng.exponential(link.host_jitter), self._arrivals[OUTBOUND])
            self._arrivals[OUTBOUND] = sent + 5e-6
            self._send(sent, can_frame(0x80))
            if sent >= next_status:
                self.now = sent + 60e-6
                self.read(0x6041, value=status(sent))
                next_status = sent + self.status_s
            if rng.random() < link.loss / 2:
                continue
            taken = max(sent + float(link.out.draw(rng, 1)[0]), self._taken + FRAME_S)
            self._taken = taken
            value = self.position(taken)
            if rng.random() < link.loss / 2:
                continue
            back = taken + link.work + float(link.back.draw(rng, 1)[0])
            received = max(back, self._arrivals[INBOUND] + 5e-6)
            self._arrivals[INBOUND] = received
            data = struct.pack("<iI", value, int(self.drive_us(taken)) & 0xFFFFFFFF)
            self.records.append((received, INBOUND, can_frame(0x180 + NODE, data)))
            self.samples.append((taken, taken, value * mechanism.COUNT_DEG))
        self.now = max(end, self.now)


def check_frames():
    """Frames that the guide and a real unit show."""
    status, position = Access(0x6041, 0), Access(0x6064, 0)
    enable = Access(0x6040, 0, 15)
    opcode, data = status.serial_request()
    known = [
        (usb_frame(opcode, data), "9002100241600001 64CF"),
        (usb_frame(*position.serial_request()), "9002100264600001 52A2"),
        (usb_frame(*enable.serial_request()), "9002110440600001 0F000000 2D2C"),
        (usb_frame(ANSWER, bytes(4)), "9002000200000000 408B"),
        (usb_frame(0, bytes.fromhex("0000000000009080")), "90020004 00000000 0000909080 1435"),
        (rs232_frame(opcode, data), "0141600001 ABF0"),
        (rs232_frame(*enable.serial_request()), "0340600001 0F000000 52EF"),
        (rs232_frame(ANSWER, bytes.fromhex("0000000037020000")), "030000000037020000 1980"),
        (status.can_request()[8:], "4041600000000000"),
        (status.can_answer(0x140)[8:], "4B41600040010000"),
    ]
    for made, expected in known:
        if made != bytes.fromhex(expected):
            raise AssertionError(f"frame {made.hex()} instead of {expected}")
