"""What the samples allow: the best of several splines, chosen with the truth in hand."""

import numpy as np


def _basis(t, t0, step, n, breaks):
    """Cubic B-splines with even knots, and a bend of each order at each break: a row per time."""
    x = (t - t0) / step
    i = np.clip(np.floor(x).astype(int), 0, n - 4)
    u = x - i
    rows = np.zeros((len(t), n))
    parts = ((1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3)
    for k, part in enumerate(parts):
        rows[np.arange(len(t)), i + k] = part / 6
    bends = []
    for at in breaks:
        after = np.maximum(t - at, 0.0) / 0.05
        bends += [after[:, None], after[:, None] ** 2]
    return np.hstack([rows, *bends])


def best_spline(samples, truth, begin, end, breaks):
    """The smallest worst error between begin and end: degrees, or None without samples.

    `samples`: true times of request and answer, degrees. The midpoint is not the instant of the
    sample, which is part of what the samples allow. `breaks`: the instants at which the motion
    bends are given for free.
    """
    out = None
    for move_begin, move_end, bends in zip(begin, end, breaks):
        sent, received, degrees = (np.array(a) for a in zip(*samples))
        trip = received - sent
        good = trip <= np.quantile(trip, 0.9)
        middle = (sent + received) / 2
        good &= (middle > move_begin - 0.05) & (middle < move_end + 0.15)
        if good.sum() < 8:
            return None
        at, values = middle[good], degrees[good]
        check = np.linspace(move_begin, move_end, 4000)
        check = check[(check > at[0]) & (check < at[-1])]
        best = np.inf
        steps = (0.005, 0.01, 0.02, 0.03, 0.05, 0.08, 0.15, 0.4, 2.0)
        for step, known in [(s, b) for s in steps for b in ([], bends)]:
            knots = int((at[-1] - at[0]) / step) + 5
            rows = _basis(at, at[0], step, knots, known)
            n = rows.shape[1]
            # The tiny rows decide splines that no sample touches.
            matrix = np.vstack([rows, 1e-6 * np.eye(n)])
            weights, *_ = np.linalg.lstsq(
                matrix, np.concatenate([values, np.zeros(n)]), rcond=None
            )
            error = _basis(check, at[0], step, knots, known) @ weights - truth(check)
            rate = truth.rate(check)
            delay = error @ rate / (rate @ rate)
            best = min(best, float(np.max(np.abs(error - delay * rate))))
        out = best if out is None else max(out, best)
    return out
