"""The tilt axis: commanded profile, servo, and what a hand or a loose coupling does to it."""

import numpy as np

COUNT_DEG = 360.0 / (4 * 500 * 120)


class Profile:
    """A trapezoid or triangle from `start` to `end` (deg) that begins at `begin` (s)."""

    def __init__(self, begin, start, end, speed, accel, decel=None):
        decel = decel or accel
        way = abs(end - start)
        self.sign = 1.0 if end >= start else -1.0
        self.begin, self.start, self.end = begin, start, end
        ramps = speed * speed / 2.0 * (1.0 / accel + 1.0 / decel)
        if ramps > way:
            speed = np.sqrt(2.0 * way / (1.0 / accel + 1.0 / decel))
        self.speed, self.accel, self.decel = speed, accel, decel
        self.up = speed / accel
        self.down = speed / decel
        cruise_way = way - speed * (self.up + self.down) / 2.0
        self.cruise = cruise_way / speed
        self.duration = self.up + self.cruise + self.down

    def __call__(self, t):
        """Angle at the times `t`, by integration of the speed."""
        s = np.clip(np.asarray(t, dtype=float) - self.begin, 0.0, self.duration)
        up = np.minimum(s, self.up)
        middle = np.clip(s - self.up, 0.0, self.cruise)
        down = np.clip(s - self.up - self.cruise, 0.0, self.down)
        way = self.accel * up * up / 2.0 + self.speed * middle
        way = way + self.speed * down - self.decel * down * down / 2.0
        return self.start + self.sign * way


class Curve:
    """Angles and rates on an even grid; cubic between them. This curve is the truth."""

    def __init__(self, t0, step, angles, rates):
        self.t0, self.step = t0, step
        self.angles, self.rates = angles, rates

    def _locate(self, t):
        x = (np.asarray(t, dtype=float) - self.t0) / self.step
        i = np.clip(np.floor(x).astype(int), 0, len(self.angles) - 2)
        return i, np.clip(x - i, 0.0, 1.0)

    def __call__(self, t):
        i, u = self._locate(t)
        h = self.step
        a, b = self.angles[i], self.angles[i + 1]
        m, n = self.rates[i] * h, self.rates[i + 1] * h
        return (
            (1 + 2 * u) * (1 - u) ** 2 * a
            + u * (1 - u) ** 2 * m
            + u * u * (3 - 2 * u) * b
            + u * u * (u - 1) * n
        )

    def rate(self, t):
        h = 1e-6
        return (self(np.asarray(t) + h) - self(np.asarray(t) - h)) / (2 * h)


class Servo:
    """The axis behind its controller.

    `lag_s`: first order. `hz` and `damping`: second order, without feed-forward, so that the axis
    lags by 2 damping / (2 pi hz) at cruise. `max_speed` and `max_accel` limit it after a
    disturbance. All None: the axis is where the profile is.
    """

    def __init__(self, lag_s=None, hz=None, damping=None, max_speed=150.0, max_accel=20_000.0):
        self.lag_s, self.hz, self.damping = lag_s, hz, damping
        self.max_speed, self.max_accel = max_speed, max_accel


def move(profile, servo, t0, t1, step, jerk_s=0.0, hold=None, pause=None, extra=None):
    """The true motion between t0 and t1.

    `jerk_s`: the acceleration needs this long to build up (moving average of the profile).
    `hold`: (from, seconds) the head is held while the profile goes on; the servo then catches up.
    `pause`: (from, seconds) the head is held and the profile waits.
    `extra`: a function of time whose degrees are added to the axis, encoder included.
    """
    n = int(np.ceil((t1 - t0) / step)) + 2
    t = t0 + step * np.arange(n)

    def wanted(times):
        times = np.asarray(times, dtype=float)
        if pause:
            begin, seconds = pause
            times = np.where(times > begin, np.maximum(times - seconds, begin), times)
        if not jerk_s:
            return profile(times)
        nodes, weights = np.polynomial.legendre.leggauss(24)
        return sum(w / 2 * profile(times - jerk_s * (x + 1) / 2) for x, w in zip(nodes, weights))

    if servo.lag_s is None and servo.hz is None:
        angles = wanted(t)
        small = step / 64
        rates = (wanted(t + small) - wanted(t - small)) / (2 * small)
        if hold:
            raise ValueError("a held head needs a servo to catch up")
    else:
        angles, rates = _integrate(servo, t, step, wanted, hold or pause)
    if extra:
        small = step / 64
        angles = angles + extra(t)
        rates = rates + (extra(t + small) - extra(t - small)) / (2 * small)
    return Curve(t0, step, angles, rates)


class Motion:
    """Curves one after another: each is the truth from its own begin on."""

    def __init__(self, rest_deg):
        self.rest_deg = rest_deg
        self.begins, self.curves = [], []

    def add(self, begin, curve):
        self.begins.append(begin)
        self.curves.append(curve)

    def __call__(self, t):
        t = np.asarray(t, dtype=float)
        out = np.full(t.shape, float(self.rest_deg))
        for begin, curve in zip(self.begins, self.curves):
            out = np.where(t >= begin, curve(t), out)
        return out

    def rate(self, t):
        small = 1e-6
        return (self(np.asarray(t) + small) - self(np.asarray(t) - small)) / (2 * small)


def _integrate(servo, t, step, wanted, hold):
    """Runge-Kutta of fourth order; the demand at whole and half steps is computed at once."""
    whole = wanted(t).tolist()
    half = wanted(t + step / 2).tolist()
    if servo.hz is None:
        stiffness, friction = None, 1.0 / servo.lag_s
    else:
        omega = 2 * np.pi * servo.hz
        stiffness, friction = omega / (2 * servo.damping), 2 * servo.damping * omega
    fastest, strongest = servo.max_speed, servo.max_accel

    def slope(x, v, demand):
        if stiffness is None:
            return max(-fastest, min(fastest, friction * (demand - x))), 0.0
        speed = max(-fastest, min(fastest, stiffness * (demand - x)))
        return v, max(-strongest, min(strongest, friction * (speed - v)))

    x, v = whole[0], 0.0
    angles, rates = np.empty(len(t)), np.empty(len(t))
    begin, end = (hold[0], hold[0] + hold[1]) if hold else (np.inf, np.inf)
    for i in range(len(t)):
        angles[i] = x
        if begin <= t[i] < end:
            v = 0.0
            rates[i] = 0.0
            continue
        d0, d1 = whole[i], half[i]
        d2 = whole[i + 1] if i + 1 < len(t) else whole[i]
        a1, b1 = slope(x, v, d0)
        rates[i] = a1
        a2, b2 = slope(x + a1 * step / 2, v + b1 * step / 2, d1)
        a3, b3 = slope(x + a2 * step / 2, v + b2 * step / 2, d1)
        a4, b4 = slope(x + a3 * step, v + b3 * step, d2)
        x += step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        v += step / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
    return angles, rates


def slip(when, degrees, seconds, back_s=0.08):
    """The axis runs away by some degrees; its controller brings it back."""

    def extra(t):
        s = np.maximum(np.asarray(t) - when, 0.0)
        u = np.minimum(s / seconds, 1.0)
        away = u * u * u * (10 - 15 * u + 6 * u * u)
        after = np.maximum(s - seconds, 0.0) / back_s
        return degrees * away * (1 + after) * np.exp(-after)

    return extra


def swing(when, degrees, hz, decay_s):
    """A jerk at the head, which swings and comes to rest."""

    def extra(t):
        s = np.maximum(np.asarray(t) - when, 0.0)
        return degrees * np.exp(-s / decay_s) * np.sin(2 * np.pi * hz * s)

    return extra


def bump(when, degrees, seconds):
    """A knock that moves the head away and back."""

    def extra(t):
        u = np.clip((np.asarray(t) - when) / seconds, 0.0, 1.0)
        return degrees * np.sin(np.pi * u) ** 2

    return extra


def counts(angle_deg, phase):
    """The encoder's counts; `phase` is the fraction of a count that homing left over."""
    return np.floor(np.asarray(angle_deg) / COUNT_DEG + 0.5 + phase).astype(np.int64)
