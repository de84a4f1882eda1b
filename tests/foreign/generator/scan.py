"""One scan: what is recorded, and the truth beside it."""

from dataclasses import dataclass, field

import numpy as np

import clocks
import drive
import lidar
import log
import mechanism

RPM_DEG_S = 0.05
EPOCH_NS = 1_795_000_000_000_000_000


@dataclass
class Move:
    to: float
    speed: float
    accel: float = 500.0


@dataclass
class Setup:
    """A condition. Everything is a fact of the simulated scanner; nothing tells the program."""

    seed: int = 0
    start: float = 0.0
    moves: list = field(default_factory=lambda: [Move(-45.0, 56.25)])
    servo: mechanism.Servo = field(default_factory=mechanism.Servo)
    jerk_s: float = 0.0
    # Per move: arguments of mechanism.move, times relative to the begin of the move.
    disturb: dict = field(default_factory=dict)
    mount_m: float = 0.06
    link: object = None
    latch_s: float = 0.0
    network: str = "quiet"
    # None: drawn from +-50 ppm, as crystals are.
    drive_ppm: float = None
    host_ppm: float = None
    lidar_ppm: float = None
    # What the lidar's clock reads at the start, seconds of the hour. None: drawn.
    lidar_offset_s: float = None
    wander_s: float = 5e-6
    host_steps: tuple = ()
    host_slews: tuple = ()
    lidar_steps: tuple = ()
    # The axis is faster than commanded by this factor; it decelerates by another rate.
    speed_factor: float = 1.0
    decel: float = None
    dither_counts: int = 0
    head_rpm: float = 600.0
    # From this time on packets take so much longer: (true time, seconds).
    detour: tuple = (0.0, 0.0)
    settle_s: float = 0.25
    # Polls before the first move.
    before_s: float = 0.06
    # Once: (from, seconds) the drive drops a request, or answers it only after that time. The host
    # gives up after 40 ms and asks again.
    stall: tuple = None
    # The statusword is read this often.
    status_s: float = 20e-3
    late: tuple = None
    share: int = 8
    # Seconds after EPOCH_NS at which the recording begins.
    epoch_s: float = 0.0
    # Added to the log's own comment; other comments of the section.
    remark: str = ""
    comments_before: tuple = ()
    comments_after: tuple = ()
    # Changes the sorted list of records before they are written: f(records, setup, rng).
    mangle: object = None


def usb_400():
    """400 Hz; a poll takes 0.8 to 2.5 ms, one in fifty up to 5 ms more each way."""
    delay = clocks.Delay(0.36e-3, "uniform", 0.425e-3, 0.02, 5e-3)
    return drive.Usb(delay, delay, 2.5e-3)


def usb_1000():
    delay = clocks.Delay(0.15e-3, "exponential", 0.06e-3, 0.02, 3e-3)
    return drive.Usb(delay, delay, 1e-3)


def usb_100():
    link = usb_400()
    link.period = 10e-3
    return link


def usb_40():
    link = usb_400()
    link.period = 25e-3
    return link


def usb_20():
    link = usb_400()
    link.period = 50e-3
    return link


def usb_10():
    link = usb_400()
    link.period = 100e-3
    return link


def usb_latency_timer():
    """The adapter's factory setting: answers wait for the end of 16 ms."""
    link = usb_400()
    link.back_grid = 16e-3
    return link


def rs232(baud=115_200):
    """A port of the machine itself."""
    return drive.Rs232(clocks.Delay(20e-6, "exponential", 40e-6, 0.01, 3e-3), 2.5e-3, baud)


def rs232_adapter():
    """Behind a USB adapter that delivers bytes within 1 ms."""
    return drive.Rs232(clocks.Delay(50e-6, "uniform", 0.5e-3, 0.01, 3e-3), 2.5e-3)


def can(period=1e-3, loss=0.0):
    """A kernel interface: a frame takes 0.13 ms on the bus, and waits for others."""
    delay = clocks.Delay(130e-6, "exponential", 40e-6, 0.01, 2e-3)
    return drive.Can(delay, delay, period, loss=loss)


def slcan(period=1e-3):
    """Behind a serial adapter on USB: 0.3 to 0.9 ms there and back."""
    delay = clocks.Delay(0.15e-3, "uniform", 0.15e-3, 0.02, 4e-3)
    return drive.Can(delay, delay, period)


def slcan_slow():
    """An adapter behind which two SYNCs are under way at a time: 0.6 to 2.6 ms."""
    delay = clocks.Delay(0.25e-3, "uniform", 0.5e-3, 0.02, 4e-3)
    return drive.Can(delay, delay, 1e-3)


class Truth:
    """What the log does not tell. Arrays over the shots that return.

    `t`: true time, `host`: the host's clock without its steps, in seconds since EPOCH_NS;
    `host_step`: the steps so far.
    """

    def __init__(self, setup, motion, packets, host, begins, ends, breaks, samples):
        self.setup, self.motion, self.host_clock = setup, motion, host
        self.t = packets.times
        self.tilt = motion(self.t)
        self.host = host.continuous(self.t) + setup.epoch_s
        self.host_step = host.reading(self.t) - host.continuous(self.t)
        self.points = packets.points
        self.number, self.channel = packets.number, packets.channel
        self.sequences = packets.sequences
        self.begins, self.ends, self.breaks = begins, ends, breaks
        self.samples = samples
        self.minimum_delay = clocks.NETWORKS[setup.network].minimum

    def true_time(self, host):
        return self.host_clock.true_time(host - self.setup.epoch_s)


def comment(setup, link):
    move = setup.moves[0]
    return f"""velomotion = "0.1.0"
device = "generator"
simulated = true
{link.settings}
[mount]
d_m = {setup.mount_m}

[lidar]
range_sd_m = 0.00058

[axis]
node = 1
encoder_lines = 500
gear = [120, 1]

[sweep]
from_deg = {setup.start}
to_deg = {move.to}
cruise_deg_s = {move.speed}
accel_deg_s2 = {move.accel}
sweeps = {len(setup.moves)}
both_ways = {"true" if len(setup.moves) > 1 else "false"}
{setup.remark}"""


def generate(setup, path):
    """Writes the log and returns its truth."""
    rng = np.random.default_rng(setup.seed)
    turn = rng.uniform(0.0, 2 * np.pi)
    host_ppm, lidar_ppm, drive_ppm = (
        drawn if stated is None else stated
        for stated, drawn in zip(
            (setup.host_ppm, setup.lidar_ppm, setup.drive_ppm), rng.uniform(-50.0, 50.0, 3)
        )
    )
    offset = rng.uniform(5.0, 3000.0)
    if setup.lidar_offset_s is not None:
        offset = setup.lidar_offset_s
    host = clocks.Clock(
        skew_ppm=host_ppm,
        wander=(setup.wander_s, 160.0, turn),
        steps=setup.host_steps,
        slews=setup.host_slews,
    )
    device = clocks.Clock(
        offset=offset,
        skew_ppm=lidar_ppm,
        wander=(setup.wander_s, 90.0, turn + 1.0),
        steps=setup.lidar_steps,
    )

    def host_ns(t):
        return EPOCH_NS + int(round((float(host.reading(t)) + setup.epoch_s) * 1e9))

    motion = mechanism.Motion(setup.start)
    tick = 1e-3 / (1.0 + drive_ppm * 1e-6)
    phase = rng.uniform(0.0, tick)
    began = rng.uniform(0.0, 4000.0)
    link = setup.link or usb_400()
    talker = drive.Host(
        link,
        motion,
        rng,
        lambda t: np.floor((began + t * (1.0 + drive_ppm * 1e-6)) * 1e6),
        rng.uniform(-0.5, 0.5),
    )
    talker.dither = setup.dither_counts
    talker.latch_s, talker.latch_phase = tick * setup.latch_s / 1e-3, phase
    talker.stall, talker.late, talker.status_s = setup.stall, setup.late, setup.status_s
    begins, ends, breaks = _operate(talker, setup, motion, tick, phase)
    stop = talker.now + 0.02
    packets = lidar.fire(device, 0.0, stop, motion, setup.mount_m, rng, setup.head_rpm, setup.share)
    received = clocks.arrivals(rng, packets.sent, clocks.NETWORKS[setup.network])
    when, longer = setup.detour
    received = received + np.where(received >= when, longer, 0.0)
    records = [(when, 1, host_ns(when), data, way) for when, way, data in talker.records]
    for payload, when in zip(packets.payloads, received):
        data = log.udp(payload, lidar.DATA_PORT)
        records.append((when, 0, host_ns(when), data, log.INBOUND))
    for when in np.arange(0.004, stop, 0.00664):
        stamp = lidar.stamps(device, np.array([when]))[0]
        data = log.udp(lidar.position_payload(stamp, 0), lidar.POSITION_PORT)
        when = when + 1e-4
        records.append((when, 0, host_ns(when), data, log.INBOUND))
    records.sort(key=lambda r: r[0])
    if setup.mangle:
        records = setup.mangle(records, setup, rng)
    comments = [*setup.comments_before, comment(setup, link), *setup.comments_after]
    log.write(path, comments, link.kind, link.name, records)
    return Truth(setup, motion, packets, host, begins, ends, breaks, talker.samples)


def _operate(talker, setup, motion, tick, phase):
    """The accesses of a capture: settings, target, start, polls, stop."""
    talker.now = 0.03
    angle = setup.start
    begins, ends, breaks = [], [], []
    talker.read(0x6041, value=0x8137)
    talker.prepare()
    talker.read(0x6064)
    for index, move in enumerate(setup.moves):
        rpm = int(round(move.speed / RPM_DEG_S))
        rpm_s = int(round(move.accel / RPM_DEG_S))
        slowing = int(round((setup.decel or move.accel) / RPM_DEG_S))
        talker.write(0x6060, 1)
        talker.read(0x6061, value=1)
        for number, value in ((0x6081, rpm), (0x6083, rpm_s), (0x6084, slowing)):
            talker.write(number, value)
            talker.read(number, value=value)
        target = int(round(move.to / mechanism.COUNT_DEG))
        talker.write(0x607A, target)
        talker.read(0x607A, value=target)
        talker.write(0x6040, 0x0F)
        talker.poll_until(talker.now + (setup.before_s if index == 0 else 0.06), lambda _: 0x8137)
        commanded = talker.write(0x6040, 0x1F)
        begin = (np.floor((commanded - phase) / tick) + 1) * tick + phase
        profile = mechanism.Profile(
            begin,
            angle,
            move.to,
            rpm * RPM_DEG_S * setup.speed_factor,
            rpm_s * RPM_DEG_S,
            setup.decel,
        )
        arguments = dict(setup.disturb.get(index, {}))
        breaks.append(_breaks(profile, arguments))
        for key in ("hold", "pause"):
            if key in arguments:
                when, seconds = arguments[key]
                arguments[key] = (begin + when, seconds)
        if "extra" in arguments:
            kind, when, *rest = arguments["extra"]
            arguments["extra"] = kind(begin + when, *rest)
        end = begin + profile.duration + arguments.get("pause", (0, 0.0))[1]
        long = end + setup.settle_s + 1.0
        step = max(1e-4, (long - begin) / 200_000)
        curve = mechanism.move(
            profile, setup.servo, begin, long, step, jerk_s=setup.jerk_s, **arguments
        )
        motion.add(begin, curve)
        begins.append(begin)
        ends.append(end)
        talker.read(0x6041, value=0x9137)
        talker.write(0x6040, 0x0F)
        talker.poll_until(end + setup.settle_s, lambda t: 0x8537 if t > end else 0x8137)
        angle = move.to
    talker.write(0x6040, 0x00)
    talker.read(0x6041, value=0x8140)
    return begins, ends, breaks


def _breaks(profile, disturbance):
    """The instants at which the motion bends: ends of ramps, and of what happens to the head."""
    down = profile.up + profile.cruise
    when, seconds = disturbance.get("pause", (np.inf, 0.0))
    out = [
        profile.begin + t + (seconds if t > when else 0.0)
        for t in (0.0, profile.up, down, profile.duration)
    ]
    for key in ("hold", "pause"):
        if key in disturbance:
            when, seconds = disturbance[key]
            out += [profile.begin + when, profile.begin + when + seconds]
    if "extra" in disturbance:
        kind, when, _, seconds, *_ = disturbance["extra"]
        out.append(profile.begin + when)
        if kind is not mechanism.swing:
            out.append(profile.begin + when + seconds)
    return out
