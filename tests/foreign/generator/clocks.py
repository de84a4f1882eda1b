"""Clocks and delays. Every time without another name is true time in seconds since the start."""

import numpy as np


class Clock:
    """An oscillator with offset, skew and a slow wander, and a counter that may be set.

    `continuous` is the oscillator; `reading` includes the steps: (true time, seconds).
    `slews`: (from, to, ppm) changes the rate of the oscillator itself.
    """

    def __init__(self, offset=0.0, skew_ppm=0.0, wander=(0.0, 160.0, 0.0), steps=(), slews=()):
        self.offset = offset
        self.skew = skew_ppm * 1e-6
        self.wander = wander
        self.steps = steps
        self.slews = slews

    def continuous(self, t):
        """Seconds since the start by this clock, without `offset`, for the sake of precision."""
        t = np.asarray(t, dtype=float)
        amplitude, period, phase = self.wander
        out = t * (1.0 + self.skew)
        if amplitude:
            turn = 2.0 * np.pi / period
            out = out + amplitude * (np.sin(turn * t + phase) - np.sin(phase))
        for begin, end, ppm in self.slews:
            out = out + ppm * 1e-6 * (np.clip(t, begin, end) - begin)
        return out

    def reading(self, t):
        t = np.asarray(t, dtype=float)
        out = self.continuous(t)
        for when, size in self.steps:
            out = out + np.where(t >= when, size, 0.0)
        return out

    def true_time(self, continuous):
        """The inverse of `continuous`."""
        wanted = np.asarray(continuous, dtype=float)
        t = wanted.copy()
        # Rates deviate by less than 0.1 %: each round gains three digits.
        for _ in range(5):
            t = t + (wanted - self.continuous(t))
        return t


class Delay:
    """A distribution of delays in seconds: a minimum, a body and rare spikes."""

    def __init__(self, minimum, body, mean, spike_share=0.0, spike=0.0, grid=0.0):
        self.minimum = minimum
        self.body = body
        self.mean = mean
        self.spike_share = spike_share
        self.spike = spike
        self.grid = grid

    def draw(self, rng, n):
        if self.body == "exponential":
            extra = rng.exponential(self.mean, n)
        elif self.body == "uniform":
            extra = rng.uniform(0.0, 2.0 * self.mean, n)
        elif self.body == "gamma":
            extra = rng.gamma(3.0, self.mean / 3.0, n)
        else:
            raise ValueError(self.body)
        spikes = rng.random(n) < self.spike_share
        return self.minimum + extra + spikes * rng.uniform(0.0, self.spike, n)


def arrivals(rng, sent, delay):
    """Arrival times on a link that keeps the order; `delay.grid` coalesces interrupts."""
    times = sent + delay.draw(rng, len(sent))
    if delay.grid:
        phase = rng.uniform(0.0, delay.grid)
        ticks = np.ceil((times - delay.minimum - phase) / delay.grid)
        times = ticks * delay.grid + phase + delay.minimum
    return np.maximum.accumulate(times)


NETWORKS = {
    "quiet": Delay(40e-6, "exponential", 25e-6, 0.002, 5e-3),
    "coalescing": Delay(40e-6, "exponential", 25e-6, 0.002, 5e-3, grid=125e-6),
    "busy": Delay(60e-6, "gamma", 800e-6, 0.01, 15e-3),
}
