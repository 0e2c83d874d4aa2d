"""Solids as signed distance functions, and their surfaces as fine triangle meshes. Needs numpy only.

A field is a function from points (n, 3) to values (n): negative inside, about the distance from the surface near it.
"""
import numpy as np

from curves import resample, rounded, smooth_interpolation


def loft(path, sections, ends):
    """Field of a body with superellipse sections along a curve in the plane y = 0.

    path: [[x, z], ...], control polygon of the curve, rounded; two points make a straight line.
    sections: [[share of the curve's length, width along y, thickness across the curve, exponent], ...],
    interpolated smoothly; exponent 2 is an ellipse, 6 nearly a rectangle.
    ends: radii of the edges around the first and the last end.
    """
    path = np.array(path, float)
    if len(path) > 2:
        path = rounded(path)
        path = resample(path, np.linalg.norm(np.diff(path, axis=0), axis=1).sum() / 24)[0]
    steps = np.diff(path, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    tangents, starts = steps / lengths[:, None], np.concatenate([[0], np.cumsum(lengths)])
    knots = np.array(sections, float)
    width, thickness, exponent = (smooth_interpolation(knots[:, [0, k]]) for k in (1, 2, 3))

    def field(points):
        x, y, z = points.T
        nearest = np.full(len(points), np.inf)
        along, across = np.zeros(len(points)), np.zeros(len(points))
        for k, (start, t, length) in enumerate(zip(path, tangents, lengths)):
            u = (x - start[0]) * t[0] + (z - start[1]) * t[1]
            v = (z - start[1]) * t[0] - (x - start[0]) * t[1]
            inside = np.clip(u, -np.inf if k == 0 else 0, np.inf if k == len(lengths) - 1 else length)
            distance = np.sqrt((u - inside) ** 2 + v ** 2)
            closer = distance < nearest
            nearest = np.where(closer, distance, nearest)
            along = np.where(closer, starts[k] + inside, along)
            across = np.where(closer, np.where(v < 0, -distance, distance), across)
        share = np.clip(along / starts[-1], 0, 1)
        side = superellipse_distance(y, across, width(share) / 2, thickness(share) / 2, exponent(share))
        return intersection(intersection(side, -along, ends[0]), along - starts[-1], ends[1])
    return field


def superellipse_distance(x, y, a, b, exponent):
    """First-order distance of points from the curve |x / a|^exponent + |y / b|^exponent = 1."""
    u, v = np.maximum(abs(x) / a, 1e-9), np.maximum(abs(y) / b, 1e-9)
    radius = (u ** exponent + v ** exponent) ** (1 / exponent)
    slope = np.hypot((u / radius) ** (exponent - 1) / a, (v / radius) ** (exponent - 1) / b)
    return (radius - 1) / slope


def union(a, b, radius):
    """Union of two fields' values with a fillet."""
    return np.maximum(np.minimum(a, b), radius) - np.hypot(np.maximum(radius - a, 0), np.maximum(radius - b, 0))


def intersection(a, b, radius):
    """Intersection of two fields' values with a rounded edge."""
    return -union(-a, -b, radius)


def gradient(field, points):
    """Gradient by four differences at the corners of a tetrahedron."""
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    step = 1e-3
    return sum(field(points + step * c)[:, None] * c for c in corners) / (4 * step)


def normals(field, points):
    """Unit gradients."""
    g = gradient(field, points)
    return g / np.linalg.norm(g, axis=1)[:, None]


def surface_net(field, low, high, step):
    """Closed mesh (vertices, triangles) of the field's zero level on a regular grid: one vertex per cell, in the
    mean of the crossings of the cell's edges, and two triangles per crossed grid edge."""
    axes = [np.arange(a, b + step, step) for a, b in zip(low, high)]
    shape = tuple(len(a) for a in axes)
    slabs = [np.stack(np.meshgrid([x], axes[1], axes[2], indexing="ij"), axis=-1).reshape(-1, 3) for x in axes[0]]
    value = np.stack([field(points).reshape(shape[1:]) for points in slabs])
    cells = tuple(n - 1 for n in shape)
    total, count, quads = np.zeros(cells + (3,)), np.zeros(cells), []
    for axis in range(3):
        lower, upper = (np.take(value, range(s, shape[axis] - 1 + s), axis) for s in (0, 1))
        at = np.argwhere((lower < 0) != (upper < 0))
        a, b = lower[tuple(at.T)], upper[tuple(at.T)]
        point = at.astype(float)
        point[:, axis] += a / (a - b)
        second, third = np.roll(np.eye(3, dtype=int), -axis, axis=0)[1:]
        around = [at - d for d in (second + third, third, 0 * second, second)]       # counter-clockwise about the axis
        for cell in around:
            np.add.at(total, tuple(cell.T), point)
            np.add.at(count, tuple(cell.T), 1)
        corners = np.stack([np.ravel_multi_index(tuple(cell.T), cells) for cell in around], axis=1)
        quads.append(np.where((a < 0)[:, None], corners, corners[:, ::-1]))
    used, quads = np.unique(np.vstack(quads), return_inverse=True)
    quads = quads.reshape(-1, 4)
    vertices = low + step * total.reshape(-1, 3)[used] / count.ravel()[used, None]
    return vertices, np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
