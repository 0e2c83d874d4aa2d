"""Curves for the generators: smooth interpolation, even spacing, rounded polygons. Needs numpy only."""
import numpy as np


def smooth_interpolation(knots):
    """Monotone cubic through [[x, y], ...], as a function of x."""
    x, y = np.array(knots, float).T
    h, slope = np.diff(x), np.diff(y) / np.diff(x)
    with np.errstate(divide="ignore"):      # where slopes of opposite signs cancel: not used
        inner = np.where(slope[:-1] * slope[1:] > 0,
                         2 / (1 / np.where(slope[:-1], slope[:-1], 1) + 1 / np.where(slope[1:], slope[1:], 1)), 0)
    tangent = np.concatenate([[slope[0]], inner, [slope[-1]]])

    def value(at):
        i = np.clip(np.searchsorted(x, at) - 1, 0, len(h) - 1)
        t = (np.clip(at, x[0], x[-1]) - x[i]) / h[i]
        return ((1 + 2 * t) * (1 - t) ** 2 * y[i] + t * (1 - t) ** 2 * h[i] * tangent[i]
                + t ** 2 * (3 - 2 * t) * y[i + 1] + t ** 2 * (t - 1) * h[i] * tangent[i + 1])
    return value


def spaced(low, high, step):
    """Values from low to high, evenly spaced, about step apart."""
    return np.linspace(low, high, max(1, round((high - low) / step)) + 1)


def resample(curve, step):
    """Points of a polyline, evenly spaced by arc length, about step apart, with their arc lengths."""
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    at = spaced(0, length[-1], step)
    return np.column_stack([np.interp(at, length, c) for c in curve.T]), at


def rounded(path, times=5):
    """The quadratic B-spline of a control polygon through both its ends, by cutting corners."""
    for _ in range(times):
        cut = np.stack([0.75 * path[:-1] + 0.25 * path[1:], 0.25 * path[:-1] + 0.75 * path[1:]], axis=1).reshape(-1, 2)
        path = np.vstack([path[:1], cut, path[-1:]])
    return path
