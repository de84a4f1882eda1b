"""The conditions: name, and the setup for a seed."""

import numpy as np

import clocks
import drive
import lidar
import mechanism
import scan
from log import INBOUND, OUTBOUND
from mechanism import Servo
from scan import Move, Setup


class Condition:
    """`setups(seed)`: one setup, or several whose logs are joined by `join`."""

    def __init__(self, group, name, make, join=None, share=0.95, most=1.0, hours=False):
        self.group, self.name, self.make, self.join = group, name, make, join
        # At least and at most these shares of the points can be placed.
        self.share, self.most = share, most
        # A silence in a sweep of which nothing tells the hours.
        self.hours = hours

    def setups(self, seed):
        made = self.make(seed)
        return made if isinstance(made, list) else [made]


ALL = []


def condition(*arguments, **more):
    ALL.append(Condition(*arguments, **more))


def plain(speed, way=None, accel=500.0, **more):
    way = way or min(45.0, 1.2 * speed)

    def make(seed):
        return Setup(seed=seed, moves=[Move(-way, speed, accel)], **more)

    return make


def inbound_missing(when):
    """The first record from the drive after a time."""

    def mangle(records, setup, rng):
        i = next(
            i for i, r in enumerate(records) if r[1] == 1 and r[4] == INBOUND and r[0] > when
        )
        return records[:i] + records[i + 1 :]

    return mangle


def written_late(seconds):
    """Packets are in the log behind younger records of the drive; times are those of receipt."""

    def mangle(records, setup, rng):
        return [((r[0] // seconds + 1) * seconds if r[1] == 0 else r[0], *r[1:]) for r in records]

    return mangle


def nothing_between(begin, end):
    """No record at all: the program did not run."""
    return lambda records, setup, rng: [r for r in records if not begin < r[0] < end]


# Plain scans.
for _speed in (56.25, 20.0, 5.0, 98.0, 0.05):
    condition("plain", f"plain, {_speed:g} deg/s", plain(_speed, way=0.12 if _speed < 1 else None))
for _name in ("coalescing", "busy"):
    condition("plain", f"plain, {_name} network", plain(56.25, network=_name))
condition("plain", "plain, 100 Hz", lambda seed: Setup(seed=seed, link=scan.usb_100()))
condition("plain", "plain, 1000 Hz", lambda seed: Setup(seed=seed, link=scan.usb_1000()))
condition(
    "plain",
    "plain, both ways",
    lambda seed: Setup(seed=seed, moves=[Move(-30.0, 56.25), Move(0.0, 56.25)]),
)
condition(
    "link",
    "USB latency timer of 16 ms",
    lambda seed: Setup(seed=seed, link=scan.usb_latency_timer()),
)

# Other links.
LINKS = {
    "RS232": scan.rs232,
    "RS232 behind USB": scan.rs232_adapter,
    "RS232 at 38,400 baud": lambda: scan.rs232(38_400),
    "CAN": scan.can,
    "CAN at 400 Hz": lambda: scan.can(2.5e-3),
    "SLCAN": scan.slcan,
    "slow SLCAN": scan.slcan_slow,
}
for _name, _link in LINKS.items():
    for _speed in (56.25, 5.0):
        condition(
            "link",
            f"{_name}, {_speed:g} deg/s",
            lambda seed, link=_link, speed=_speed: Setup(
                seed=seed,
                link=link(),
                moves=[Move(-min(45.0, 1.2 * speed), speed)],
            ),
        )
for _name, _link in (
    ("CAN, 40 % lost", lambda: scan.can(loss=0.4)),
    ("CAN, 10 % lost", lambda: scan.can(loss=0.1)),
):
    condition(
        "link", _name, lambda seed, link=_link: Setup(seed=seed, link=link())
    )
for _name in ("RS232", "CAN", "SLCAN"):
    condition(
        "link",
        f"latch 1 ms, {_name}",
        lambda seed, link=LINKS[_name]: Setup(
            seed=seed, link=link(), latch_s=1e-3
        ),
    )
    condition(
        "link",
        f"one answer missing, {_name}",
        lambda seed, link=LINKS[_name]: Setup(
            seed=seed, link=link(), mangle=inbound_missing(0.5)
        ),
    )
    condition(
        "link",
        f"host clock steps +1.2 ms, {_name}",
        lambda seed, link=LINKS[_name]: Setup(
            seed=seed, link=link(), host_steps=((0.62, 1.2e-3),)
        ),
    )

# Servos.
SERVOS = {
    "lag 4 ms": Servo(lag_s=4e-3),
    "30 Hz .5": Servo(hz=30.0, damping=0.5),
    "15 Hz .5": Servo(hz=15.0, damping=0.5),
    "15 Hz 1": Servo(hz=15.0, damping=1.0),
    "8 Hz .7": Servo(hz=8.0, damping=0.7),
}
for _name, _servo in SERVOS.items():
    for _accel in (500.0, 2000.0, 5000.0, 10_000.0):
        condition(
            "servo", f"servo {_name}, {_accel:g} deg/s2", plain(56.25, accel=_accel, servo=_servo)
        )
for _accel in (500.0, 5000.0):
    condition(
        "servo",
        f"jerk 5 ms, {_accel:g} deg/s2",
        plain(56.25, accel=_accel, jerk_s=5e-3, servo=SERVOS["30 Hz .5"]),
    )

# What happens to the head.
CATCHES_UP = Servo(hz=20.0, damping=0.8)


def disturbed(servo=CATCHES_UP, **what):
    return plain(56.25, servo=servo, disturb={0: what})


condition("head", "held 150 ms, catches up", disturbed(hold=(0.35, 0.15)))
condition("head", "held 200 ms, catches up", disturbed(hold=(0.40, 0.20)))
condition("head", "held 150 ms, goes on late", disturbed(pause=(0.35, 0.15)))
condition("head", "held 200 ms, goes on late", disturbed(pause=(0.40, 0.20)))
condition("head", "slips 1.5 deg in 30 ms", disturbed(extra=(mechanism.slip, 0.4, -1.5, 0.03)))
condition("head", "slips 0.2 deg in 20 ms", disturbed(extra=(mechanism.slip, 0.5, -0.2, 0.02)))
condition(
    "head",
    "jerked, swings 0.5 deg at 12 Hz",
    disturbed(extra=(mechanism.swing, 0.4, 0.5, 12, 0.06)),
)
condition("head", "bumped 0.4 deg for 40 ms", disturbed(extra=(mechanism.bump, 0.45, 0.4, 0.04)))
condition("head", "bumped 0.05 deg for 40 ms", disturbed(extra=(mechanism.bump, 0.45, 0.05, 0.04)))
condition("head", "bumped 2 deg for 80 ms", disturbed(extra=(mechanism.bump, 0.45, 2.0, 0.08)))

# A drive that renews 6064 once per millisecond.
for _speed in (56.25, 5.0, 98.0):
    for _name, _link in (("400 Hz", scan.usb_400), ("1000 Hz", scan.usb_1000)):
        condition(
            "latch",
            f"latch 1 ms, {_speed:g} deg/s, {_name}",
            lambda seed, speed=_speed, link=_link: Setup(
                seed=seed,
                moves=[Move(-min(45.0, 1.2 * speed), speed)],
                link=link(),
                latch_s=1e-3,
            ),
        )
condition(
    "latch",
    "latch 1 ms, servo 15 Hz .5",
    lambda seed: Setup(seed=seed, latch_s=1e-3, servo=SERVOS["15 Hz .5"]),
)



def regular(period):
    """Polls in step with the drive's cycle: each position has the same age."""
    delay = clocks.Delay(0.15e-3, "exponential", 10e-6)
    return drive.Usb(delay, delay, period, host_jitter=2e-6)


for _name, _period in (("500 Hz", 2e-3), ("1000 Hz", 1e-3)):
    condition(
        "latch",
        f"latch 1 ms, {_name} in step with it",
        lambda seed, period=_period: Setup(
            seed=seed, link=regular(period), latch_s=1e-3, drive_ppm=0.0, host_ppm=0.0
        ),
    )

# Clocks. A move begins some 0.1 s after the start.
for _ms in (0.1, -0.1, 0.3, -0.3, 1.2, -1.2, 5.0, -5.0):
    condition(
        "clock",
        f"lidar clock steps {_ms:+g} ms",
        lambda seed, ms=_ms: Setup(seed=seed, lidar_steps=((0.6, ms * 1e-3),)),
    )
# Whole packets of 1.327104 ms, on which the spacing shows nothing, and near them.
for _count, _us in ((1, 0), (-1, 0), (2, 15), (-2, -15), (3, 0), (-3, 0)):
    condition(
        "clock",
        f"lidar clock steps by {_count:+d} packets {_us:+d} us",
        lambda seed, count=_count, us=_us: Setup(
            seed=seed, lidar_steps=((0.6, count * lidar.PACKET_S + us * 1e-6),)
        ),
    )
for _network, _ms in (("coalescing", 1.2), ("busy", 1.2), ("busy", 5.0)):
    condition(
        "clock",
        f"lidar clock steps {_ms:+g} ms, {_network} network",
        lambda seed, ms=_ms, network=_network: Setup(
            seed=seed, network=network, lidar_steps=((0.6, ms * 1e-3),)
        ),
    )
for _ms in (0.1, -0.1, 0.3, -0.3, 0.5, -0.5, 1.2, 6.0, -6.0, 20.0, -20.0, 1500.0):
    condition(
        "clock" if abs(_ms) > 0.2 else "more",
        f"host clock steps {_ms:+g} ms",
        lambda seed, ms=_ms: Setup(seed=seed, host_steps=((0.62, ms * 1e-3),)),
    )
# Recorded for longer, so that the spread of the least delays is known.
for _name, _link in (("USB 400 Hz", scan.usb_400), ("USB 1000 Hz", scan.usb_1000),
                     ("CAN", scan.can), ("RS232", scan.rs232)):  # fmt: skip
    for _ms in (0.15, -0.15, 0.5, -0.5):
        condition(
            "clock" if abs(_ms) > 0.2 else "more",
            f"host clock steps {_ms:+g} ms after 4 s, {_name}",
            lambda seed, ms=_ms, link=_link: Setup(
                seed=seed, link=link(), before_s=4.0, host_steps=((4.55, ms * 1e-3),)
            ),
        )
condition(
    "clock",
    "lidar clock corrected by 17.3 s",
    lambda seed: Setup(seed=seed, lidar_steps=((0.6, 17.3),)),
)
condition(
    "clock",
    "lidar clock's hour ends",
    lambda seed: Setup(seed=seed, lidar_offset_s=3599.4),
)
condition(
    "clock",
    "lidar clock's hour ends at a step of 1.2 ms",
    lambda seed: Setup(seed=seed, lidar_offset_s=3599.4, lidar_steps=((0.6005, 1.2e-3),)),
)
for _s in (-0.4, 0.4, 0.005, -0.005):
    condition(
        "clock",
        f"host suspended for 2 s and set by {_s:+g} s",
        lambda seed, s=_s: Setup(
            seed=seed,
            before_s=4.0,
            host_steps=((2.9, s),),
            mangle=nothing_between(1.0, 3.0),
        ),
    )
# The drive's records pause for the silence and the step together. In a sweep whole hours are refused, as the lidar's stamps
# repeat hourly.
for _asleep, _steps in ((0.2, (0.05, 0.3, -0.3)), (0.6, (0.05, 0.3, -0.05, -0.3, 7200.0))):
    for _s in _steps:
        condition(
            "clock",
            f"host suspended for {_asleep:g} s at rest and set by {_s:+g} s",
            lambda seed, asleep=_asleep, s=_s: Setup(
                seed=seed,
                before_s=4.0,
                host_steps=((2.0, s),),
                mangle=nothing_between(2.0 - asleep / 2, 2.0 + asleep / 2),
            ),
        )
        for _name, _link in (("USB", scan.usb_400), ("CAN", scan.can), ("RS232", scan.rs232)):
            condition(
                "clock",
                f"host suspended for {_asleep:g} s in a sweep and set by {_s:+g} s, {_name}",
                lambda seed, asleep=_asleep, s=_s, link=_link: Setup(
                    seed=seed,
                    link=link(),
                    moves=[Move(-40.0, 10.0)],
                    share=4,
                    host_steps=((2.0, s),),
                    mangle=nothing_between(2.0 - asleep / 2, 2.0 + asleep / 2),
                ),
                share=0.8,
                hours=_s >= 3_600,
            )
for _s in (0.3, -0.3, 7200.0):
    condition(
        "clock",
        f"host suspended for 2 s in a sweep and set by {_s:+g} s",
        lambda seed, s=_s: Setup(
            seed=seed,
            moves=[Move(-40.0, 10.0)],
            share=4,
            host_steps=((2.5, s),),
            mangle=nothing_between(1.5, 3.5),
        ),
        share=0.4,
        hours=_s >= 3_600,
    )
for _s in (0.3, -0.0503, -100.0):
    condition(
        "clock",
        f"lidar clock set by {_s:+g} s while the host is suspended for 0.2 s",
        lambda seed, s=_s: Setup(
            seed=seed,
            moves=[Move(-40.0, 10.0)],
            share=4,
            lidar_steps=((2.0, s),),
            mangle=nothing_between(1.9, 2.1),
        ),
        share=0.9,
    )
# A pulse per second that is at hand for a part of the time.
for _ms, _every in ((0.1, 1.0), (-0.1, 1.0), (0.3, 1.0), (1.2, 1.0), (5.0, 1.0), (0.2, 0.25)):
    condition(
        "clock",
        f"lidar clock steps {_ms:+g} ms five times, every {_every:g} s",
        lambda seed, ms=_ms, every=_every: Setup(
            seed=seed,
            moves=[Move(-40.0, 10.0)],
            share=4,
            lidar_steps=tuple((0.3 + every * k, ms * 1e-3) for k in range(5)),
        ),
    )
condition(
    "clock",
    "host clock slewed by 500 ppm",
    lambda seed: Setup(
        seed=seed, moves=[Move(-40.0, 10.0)], host_slews=((1.0, 3.0, 500.0),), share=4
    ),
)
condition(
    "clock",
    "host clock slewed by 500 ppm throughout",
    lambda seed: Setup(
        seed=seed, moves=[Move(-60.0, 5.0)], host_slews=((0.0, 60.0, 500.0),), share=2
    ),
)
condition(
    "clock",
    "host and lidar step in one scan",
    lambda seed: Setup(seed=seed, host_steps=((0.5, 0.02),), lidar_steps=((0.75, 1.2e-3),)),
)


# Acceleration that rises evenly, and a drive that renews 6064 once per millisecond.
for _jerk, _accel in ((0.03, 1000.0), (0.06, 500.0), (0.1, 500.0)):
    for _name, _link in (("RS232", scan.rs232), ("CAN", scan.can), ("USB 1000 Hz", scan.usb_1000)):
        for _servo in ("none", "30 Hz .5", "15 Hz .5"):
            condition(
                "jerk",
                f"jerk {_jerk * 1e3:g} ms, latch 1 ms, {_name}, servo {_servo}",
                plain(
                    56.25,
                    accel=_accel,
                    jerk_s=_jerk,
                    servo=SERVOS.get(_servo, Servo()),
                    link=_link(),
                    latch_s=1e-3,
                ),
            )


# What is missing in the log.
POLL = "900210026460000152a2"


def _is_poll(r):
    return r[1] == 1 and r[4] == OUTBOUND and r[3].hex() == POLL


def _after(records, i, direction):
    for j in range(i + 1, len(records)):
        if records[j][1] == 1 and records[j][4] == direction:
            return j
    return None


def _polls(records, begin, end):
    return [i for i, r in enumerate(records) if _is_poll(r) and begin <= r[0] < end]


def without(choose):
    """Drops the records whose indices `choose` returns."""

    def mangle(records, setup, rng):
        gone = set(choose(records, rng))
        return [r for i, r in enumerate(records) if i not in gone]

    return mangle


def answers_missing(times):
    def choose(records, rng):
        return [_after(records, _polls(records, t, t + 1)[0], INBOUND) for t in times]

    return without(choose)


def part_missing(begin, end):
    """Answers only, as where a recorder falls behind."""
    return without(
        lambda records, rng: [
            i
            for i, r in enumerate(records)
            if r[1] == 1 and r[4] == INBOUND and begin < r[0] < end
        ]
    )


def requests_missing(times):
    return without(lambda records, rng: [_polls(records, t, t + 1)[0] for t in times])


def share_of_answers(share):
    def choose(records, rng):
        answers = [i for i, r in enumerate(records) if r[1] == 1 and r[4] == INBOUND and r[0] > 0.3]
        return [i for i in answers if rng.random() < share]

    return without(choose)


def acknowledgement_missing(start):
    def choose(records, rng):
        for i, r in enumerate(records):
            if r[1] == 1 and r[4] == OUTBOUND and r[3].hex().startswith(start):
                return [_after(records, i, INBOUND)]
        raise ValueError(start)

    return without(choose)


def _is_write(record, index, value=None):
    """Whether a record requests a write of an object, and of this value. The frame is a link's."""
    if record[1] != 1 or record[4] != OUTBOUND:
        return False
    data, object_ = record[3], index.to_bytes(2, "little") + b"\0"
    if data[:2] == b"\x90\x02":
        begin, is_write = 4, data[2] == drive.WRITE
    elif len(data) == 16:
        begin, is_write = 9, data[8] in (0x23, 0x2B, 0x2F)
    else:
        begin, is_write = 1, data[:1] == b"\x03"
    content = data[begin + 4 :] if len(data) != 16 else data[begin + 3 :]
    fits = value is None or content[: len(value)] == value
    return is_write and data[begin : begin + 3] == object_ and fits


START = b"\x1f\x00"
MOVE_REQUESTS = {
    "607A": (0x607A, None),
    "the start": (0x6040, START),
    "6081": (0x6081, None),
    "6060": (0x6060, None),
}


def move_requests_missing(names, move=0, read_back=True):
    """Requests of writes of a move, whose acknowledgements remain. Without `read_back` no read of
    the same object is in the log either."""

    def choose(records, rng):
        gone = []
        for name in names:
            index, value = MOVE_REQUESTS[name]
            found = [i for i, r in enumerate(records) if _is_write(r, index, value)]
            gone.append(found[move])
            if not read_back and name != "the start":
                after = [i for i in range(found[move] + 1, len(records)) if records[i][1] == 1]
                # The acknowledgement, and the whole read that follows.
                gone += after[:3]
        return gone

    return without(choose)


def other_answer_missing(start, when=0.5):
    def choose(records, rng):
        for i, r in enumerate(records):
            asked = r[1] == 1 and r[4] == OUTBOUND and r[0] > when
            if asked and r[3].hex().startswith(start):
                return [_after(records, i, INBOUND)]
        raise ValueError(start)

    return without(choose)


def packets_missing(when, count):
    def choose(records, rng):
        data = [i for i, r in enumerate(records) if r[1] == 0 and len(r[3]) == 1248 and r[0] > when]
        return data[:count]

    return without(choose)


def share_of_packets(share):
    def choose(records, rng):
        data = [i for i, r in enumerate(records) if r[1] == 0 and len(r[3]) == 1248]
        return [i for i in data if rng.random() < share]

    return without(choose)


def silent_between(begin, end):
    """No record of the drive in between."""
    return without(
        lambda records, rng: [i for i, r in enumerate(records) if r[1] == 1 and begin < r[0] < end]
    )


def doubled(share):
    """Packets that the log holds twice, in bursts of up to 20."""

    def mangle(records, setup, rng):
        out, burst = [], 0
        held = []
        for r in records:
            out.append(r)
            if r[1] == 0 and len(r[3]) == 1248:
                if burst == 0 and held:
                    out.extend((r[0], *x[1:2], r[2] + 1000 * k, *x[3:]) for k, x in enumerate(held))
                    held = []
                if burst == 0 and rng.random() < share:
                    burst = int(rng.integers(1, 20))
                if burst:
                    held.append(r)
                    burst -= 1
        return out

    return mangle


def wild_position(when, counts):
    """A poll over USB whose answer is off by so much, its checksum right."""

    def mangle(records, setup, rng):
        out = list(records)
        i = _after(out, _polls(out, when, when + 1)[0], INBOUND)
        data = out[i][3].replace(b"\x90\x90", b"\x90")
        words = data[data.index(b"\x02") + 1 :][2:10]
        position = int.from_bytes(words[4:], "little", signed=True) + counts
        answer = drive.usb_frame(0, words[:4] + position.to_bytes(4, "little", signed=True))
        out[i] = (*out[i][:3], answer, out[i][4])
        return out

    return mangle


def missing(name, mangle, share=0.95, most=1.0, **more):
    def make(seed):
        return Setup(seed=seed, mangle=mangle, **more)

    condition("missing", name, make, share=share, most=most)


missing("one answer missing", answers_missing([0.5]))
missing("one answer missing, 1000 Hz", answers_missing([0.5]), link=scan.usb_1000())
missing("one answer missing, 5 deg/s", answers_missing([0.5]), moves=[Move(-6.0, 5.0)])
missing("one answer missing, 40 Hz", answers_missing([0.5]), link=scan.usb_40())
missing(
    "one answer missing, latency timer of 16 ms",
    answers_missing([0.5]),
    link=scan.usb_latency_timer(),
)
for _name, _link in (("400 Hz", scan.usb_400), ("40 Hz", scan.usb_40)):
    missing(
        f"one answer missing, {_name}, nothing but polls",
        answers_missing([0.5]),
        link=_link(),
        status_s=float("inf"),
    )
for _name, _link in (("20 Hz", scan.usb_20), ("10 Hz", scan.usb_10)):
    for _status in (20e-3, float("inf")):
        missing(
            f"one answer missing, {_name}" + ("" if _status < 1 else ", nothing but polls"),
            answers_missing([0.5]),
            link=_link(),
            status_s=_status,
        )
missing(
    "one answer missing, latency timer of 16 ms, nothing but polls",
    answers_missing([0.5]),
    link=scan.usb_latency_timer(),
    status_s=float("inf"),
)
missing("all answers missing for 30 ms", part_missing(0.5, 0.53))
missing("drive does not answer for 60 ms", without(lambda records, rng: []), stall=(0.5, 0.06))
missing("drive answers 60 ms late", without(lambda records, rng: []), late=(0.5, 0.06))
missing("three answers missing", answers_missing([0.3, 0.55, 0.8]))
missing("one request missing", requests_missing([0.5]))
missing("2 % of the drive's answers missing", share_of_answers(0.02))
for _name in MOVE_REQUESTS:
    missing(f"request of {_name} missing", move_requests_missing([_name]))
missing("requests of 607A and the start missing", move_requests_missing(["607A", "the start"]))
missing(
    "607A neither written nor read back",
    move_requests_missing(["607A"], read_back=False),
)
missing(
    "607A neither written nor read back, no start",
    move_requests_missing(["607A", "the start"], read_back=False),
)
for _name, _link in (("RS232", scan.rs232), ("CAN", scan.can)):
    for _request in ("607A", "the start"):
        missing(
            f"request of {_request} missing, {_name}",
            move_requests_missing([_request]),
            link=_link(),
        )
missing(
    "request of the start missing, 0.5 deg/s",
    move_requests_missing(["the start"]),
    moves=[Move(-0.6, 0.5)],
)
for _name in ("607A", "the start"):
    missing(
        f"request of {_name} missing in the second of two sweeps",
        move_requests_missing([_name], move=1),
        moves=[Move(-30.0, 56.25), Move(0.0, 56.25)],
    )
missing("acknowledgement of 607A missing", acknowledgement_missing("900211047a60"))
missing("acknowledgement of the start missing", acknowledgement_missing("9002110440600001" + "1f"))
missing("answer of a statusword missing", other_answer_missing("9002100241600001"))
missing(
    "answer of a statusword missing, 1000 Hz",
    other_answer_missing("9002100241600001"),
    link=scan.usb_1000(),
)
missing("one position wrong by 1,000 counts", wild_position(0.5, 1000))
missing("3 packets missing", packets_missing(0.6, 3))
missing("40 packets missing", packets_missing(0.6, 40), share=0.9)
missing("2 % of the packets missing", share_of_packets(0.02))
missing("no record of the drive for 100 ms", silent_between(0.5, 0.6))


missing("no record of the drive in the sweep", silent_between(0.2, 1.15), share=0.0, most=0.2)
missing("no record of the drive for 0.5 s", silent_between(0.4, 0.9), share=0.0)


def _no_polls_in_second(records, setup, rng):
    """No position of the second move, though everything else is there."""
    starts = [
        i
        for i, r in enumerate(records)
        if r[1] == 1 and r[4] == OUTBOUND and r[3].hex().startswith("90021104406000011f")
    ]
    begin = records[starts[1]][0] - 0.05
    gone = set()
    for i, r in enumerate(records):
        if r[0] > begin and _is_poll(r):
            gone |= {i, _after(records, i, INBOUND)}
    return [r for i, r in enumerate(records) if i not in gone]


condition(
    "missing",
    "no polls in the second of two sweeps",
    lambda seed: Setup(
        seed=seed,
        moves=[Move(-30.0, 56.25), Move(0.0, 56.25)],
        mangle=_no_polls_in_second,
    ),
    share=0.45,
)

# Files.
condition("files", "packets doubled in bursts", lambda seed: Setup(seed=seed, mangle=doubled(0.02)))


condition(
    "files",
    "a remark before the end of the comment",
    lambda seed: Setup(seed=seed, remark="# scanned by another person\n"),
)
condition(
    "files",
    "another comment after",
    lambda seed: Setup(seed=seed, comments_after=("hall, second floor",)),
)
condition(
    "files",
    "another comment before",
    lambda seed: Setup(seed=seed, comments_before=("hall, second floor",)),
)

condition("files", "cut off within a record", lambda seed: Setup(seed=seed), join="cut", share=0.5)
condition(
    "files",
    "packets written in batches of 7 ms",
    lambda seed: Setup(seed=seed, mangle=written_late(7e-3)),
)


def block_twice(count, when=0.5):
    """A recorder that repeats a write: so many records come again after them, with their stamps."""

    def mangle(records, setup, rng):
        k = next(i for i, r in enumerate(records) if r[0] > when)
        # In this order, which is by stamps otherwise.
        twice = records[: k + count] + records[k:]
        return [(i * 1e-6, *r[1:]) for i, r in enumerate(twice)]

    return mangle


def part_again(begin, end, delay, of_drive):
    """A part of one device comes again later: the drive's with its stamps, packets with others."""

    def mangle(records, setup, rng):
        part = [
            r
            for r in records
            if begin < r[0] < end and (r[1] == 1 if of_drive else r[1] == 0 and len(r[3]) == 1248)
        ]
        later = 0 if of_drive else int(delay * 1e9)
        again = [(r[0] + delay, r[1], r[2] + later, *r[3:]) for r in part]
        return sorted(records + again, key=lambda r: r[0])

    return mangle


for _count in (20, 100, 400, 1500):
    condition(
        "files",
        f"{_count} records in a row twice",
        lambda seed, count=_count: Setup(seed=seed, mangle=block_twice(count)),
    )
for _name, _link in (("USB", scan.usb_400), ("RS232", scan.rs232), ("CAN", scan.can)):
    condition(
        "files",
        f"the drive's records of 30 ms twice, {_name}",
        lambda seed, link=_link: Setup(
            seed=seed, link=link(), mangle=part_again(0.5, 0.53, 0.03, True)
        ),
    )
for _ms in (10, 90, 400):
    condition(
        "files",
        f"50 ms of the packets again after {_ms} ms",
        lambda seed, ms=_ms: Setup(
            seed=seed, mangle=part_again(0.5, 0.55, 0.05 + ms * 1e-3, False)
        ),
    )


def without_handshakes(records, setup, rng):
    """RS232 with a record per frame: neither side's single handshakes."""
    return [r for r in records if r[1] == 0 or r[3] != b"O"]


condition(
    "files",
    "RS232 without handshakes",
    lambda seed: Setup(seed=seed, link=scan.rs232(), mangle=without_handshakes),
)


def every_record_twice(records, setup, rng):
    return [r for r in records for _ in range(2)]


condition("files", "every record twice", lambda seed: Setup(seed=seed, mangle=every_record_twice))
condition(
    "files",
    "two logs by cat",
    lambda seed: [Setup(seed=seed), Setup(seed=seed + 1000, epoch_s=7.0)],
    join="cat",
)
condition(
    "files",
    "two logs by cat, the later first",
    lambda seed: [Setup(seed=seed, epoch_s=3104.9), Setup(seed=seed + 1000)],
    join="cat",
)
condition(
    "files",
    "one log twice by cat",
    lambda seed: Setup(seed=seed),
    join="cat twice",
    share=0.0,
)
condition("files", "one log by mergecap", lambda seed: Setup(seed=seed), join="mergecap")
condition(
    "files",
    "two logs by mergecap",
    lambda seed: [Setup(seed=seed), Setup(seed=seed + 1000, epoch_s=7.0)],
    join="mergecap",
)
condition(
    "files",
    "two logs of one time by mergecap",
    lambda seed: [Setup(seed=seed), Setup(seed=seed + 1000, epoch_s=0.3)],
    join="mergecap",
)

condition(
    "files",
    "two logs by cat, the first cut off within a record",
    lambda seed: [Setup(seed=seed), Setup(seed=seed + 1000, epoch_s=7.0)],
    join="cut, cat",
)
condition(
    "files",
    "two logs merged without a comment",
    lambda seed: [Setup(seed=seed), Setup(seed=seed + 1000, epoch_s=7.0)],
    join="merged",
)

# Other things that happen.


def asymmetric():
    fast = clocks.Delay(0.15e-3, "exponential", 0.05e-3)
    slow = clocks.Delay(1.4e-3, "exponential", 0.1e-3)
    return drive.Usb(fast, slow, 2.5e-3)


def swapped(share):
    """Packets that arrive just after their successor."""

    def mangle(records, setup, rng):
        out = list(records)
        data = [i for i, r in enumerate(out) if r[1] == 0 and len(r[3]) == 1248]
        for a, b in zip(data[:-1:2], data[1::2]):
            if rng.random() < share:
                first, second = out[a], out[b]
                out[a] = second
                out[b] = (second[0] + 5e-6, 0, second[2] + 5000, *first[3:])
        return out

    return mangle


def first_polls_missing(until):
    def choose(records, rng):
        gone = []
        for i in _polls(records, 0.0, until):
            gone += [i, _after(records, i, INBOUND)]
        return gone

    return without(choose)


for _name, _setup in {
    "answers take ten times as long as requests": {"link": asymmetric()},
    "asymmetric, latch 1 ms": {"link": asymmetric(), "latch_s": 1e-3},
    "dither of 2 counts": {"dither_counts": 2},
    "3 % faster than commanded": {"speed_factor": 1.03},
    "decelerates at 2000 deg/s2": {"decel": 2000.0},
    "triangle of 4 deg": {"moves": [Move(-4.0, 56.25)]},
    "head at 1200 rpm": {"head_rpm": 1200.0},
    "head at 300 rpm": {"head_rpm": 300.0},
    "packets overtake each other": {"mangle": swapped(0.05)},
    "network becomes 0.5 ms slower": {"detour": (0.6, 0.5e-3)},
    "no polls in the first ramp": {"mangle": first_polls_missing(0.25)},
    "three sweeps": {"moves": [Move(-20.0, 56.25), Move(0.0, 56.25), Move(-20.0, 56.25)]},
    "crystals 100 ppm off": {"host_ppm": 100.0, "lidar_ppm": -100.0},
}.items():
    # Without polls in its ramp a motion is shown by the polls after it alone: 85 % of the points.
    _share = 0.8 if "first ramp" in _name else 0.95
    condition("more", _name, lambda seed, setup=_setup: Setup(seed=seed, **setup), share=_share)


def drawn(seed):
    """A scanner that works: any link, servo, speed and clocks, a latch or none."""
    rng = np.random.default_rng(1_000_000 + seed)
    links = [
        scan.usb_400, scan.usb_400, scan.usb_1000, scan.usb_1000, scan.usb_100,
        *LINKS.values(),
    ]  # fmt: skip
    speed = float(np.round(np.exp(rng.uniform(np.log(0.5), np.log(98.0))) / 0.05) * 0.05)
    accel = float(rng.choice([500.0, 1000.0, 2000.0, 5000.0, 10_000.0]))
    servo = Servo()
    if rng.random() < 0.6:
        servo = list(SERVOS.values())[rng.integers(len(SERVOS))]
    return Setup(
        seed=seed,
        moves=[Move(-min(45.0, float(rng.uniform(0.6, 1.5)) * speed), speed, accel)],
        servo=servo,
        link=links[rng.integers(len(links))](),
        latch_s=float(rng.choice([0.0, 1e-3])),
        network=str(rng.choice(["quiet", "coalescing", "busy"])),
    )


condition("drawn", "drawn at random", drawn)


def drawn_with_jerk(seed):
    """A scanner as in `drawn` whose acceleration rises evenly."""
    setup = drawn(seed)
    rng = np.random.default_rng(3_000_000 + seed)
    setup.jerk_s = float(rng.choice([5e-3, 15e-3, 30e-3, 60e-3, 100e-3]))
    setup.moves[0].accel = float(rng.choice([500.0, 1000.0, 2000.0]))
    return setup


condition("drawn with jerk", "drawn at random, with limited jerk", drawn_with_jerk)


def _disturbance(rng, duration):
    """What may happen to the head between the ramps of a move, or nothing."""
    when = float(rng.uniform(0.15, 0.75)) * duration
    kinds = {
        "hold": lambda: {"hold": (when, float(rng.uniform(0.05, 0.3)))},
        "pause": lambda: {"pause": (when, float(rng.uniform(0.05, 0.3)))},
        "slip": lambda: {
            "extra": (mechanism.slip, when, float(rng.uniform(-2, 2)), float(rng.uniform(0.02, 0.06)))
        },
        "swing": lambda: {
            "extra": (
                mechanism.swing, when, float(rng.uniform(0.02, 0.6)),
                float(rng.uniform(5, 20)), float(rng.uniform(0.04, 0.2)),
            )
        },
        "bump": lambda: {
            "extra": (mechanism.bump, when, float(rng.uniform(-2, 2)), float(rng.uniform(0.03, 0.1)))
        },
    }  # fmt: skip
    return kinds[str(rng.choice(list(kinds)))]()


def _missing_records(rng, duration):
    """Records that the recorder drops."""
    when = 0.15 + float(rng.uniform(0.1, 0.9)) * duration
    kinds = (
        lambda: share_of_answers(float(rng.uniform(0.002, 0.05))),
        lambda: part_missing(when, when + float(rng.uniform(0.01, 0.1))),
        lambda: silent_between(when, when + float(rng.uniform(0.01, 0.15))),
        lambda: share_of_packets(float(rng.uniform(0.002, 0.05))),
        lambda: move_requests_missing([str(rng.choice(list(MOVE_REQUESTS)))]),
        lambda: move_requests_missing(["607A"], read_back=False),
    )
    return kinds[rng.integers(len(kinds))]()


def drawn_with_faults(seed):
    """A scanner as in `drawn`, to which one or two things happen."""
    rng = np.random.default_rng(2_000_000 + seed)
    setup = drawn(500_000 + seed)
    setup.seed = seed
    move = setup.moves[0]
    duration = abs(move.to) / move.speed + move.speed / move.accel
    sweeps = int(rng.choice([1, 1, 2, 3]))
    setup.moves = [Move((move.to, 0.0)[i % 2], move.speed, move.accel) for i in range(sweeps)]
    faults = ["head", "host", "lidar", "records"]
    for fault in rng.choice(faults, size=int(rng.integers(1, 3)), replace=False):
        when = 0.15 + float(rng.uniform(0.1, 0.9)) * duration
        size = float(np.exp(rng.uniform(np.log(1e-3), np.log(2.0)))) * float(rng.choice([-1, 1]))
        if fault == "head":
            # A head that is held needs a servo that catches up.
            if setup.servo.hz is None and setup.servo.lag_s is None:
                setup.servo = CATCHES_UP
            setup.disturb = {int(rng.integers(sweeps)): _disturbance(rng, duration)}
        elif fault == "host":
            setup.host_steps = ((when, size),)
        elif fault == "lidar":
            setup.lidar_steps = ((when, size / 10),)
        else:
            setup.mangle = _missing_records(rng, duration)
    return setup


condition("faults", "drawn at random, with faults", drawn_with_faults, share=0.85)
