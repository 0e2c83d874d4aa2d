"""Triangle meshes for the generators: convex hulls, OBJ files, mesh checks, distances. Needs numpy only."""
import itertools

import numpy as np


def read_obj(path):
    """Vertices (n, 3) and triangles (m, 3) of a text OBJ with triangular faces."""
    vertices, faces = [], []
    with open(path) as lines:
        for line in lines:
            words = line.split()
            if words and words[0] == "v":
                vertices.append([float(w) for w in words[1:4]])
            elif words and words[0] == "f":
                faces.append([int(w.split("/")[0]) - 1 for w in words[1:4]])
    return np.array(vertices), np.array(faces)


def write_obj(path, vertices, faces, comment):
    """Writes metres with seven decimals."""
    with open(path, "w") as out:
        out.write(f"# {comment}\n# CC0-1.0. Units: metres.\n")
        out.writelines("v {:.7f} {:.7f} {:.7f}\n".format(*(v + 0.0)) for v in np.round(vertices, 7))
        out.writelines("f {} {} {}\n".format(*(f + 1)) for f in faces)


def convex_hull(points):
    """Convex hull as (vertices, triangles), by testing every triple of points.

    Coplanar points form one facet, which is cut into triangles by clipping the ear with the
    largest smallest angle. Meant for up to about a hundred points.
    """
    points = np.unique(np.round(points, 9), axis=0)
    tolerance = 1e-8 * np.ptp(points, axis=0).max()
    triples = np.array(list(itertools.combinations(range(len(points)), 3)))
    a, b, c = points[triples.T]
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    keep = lengths > 1e-6
    a, normals = a[keep], normals[keep] / lengths[keep, None]
    heights = normals @ points.T - np.sum(normals * a, axis=1)[:, None]
    below, above = (heights < tolerance).all(axis=1), (heights > -tolerance).all(axis=1)
    facets = {}
    for row in np.flatnonzero(below | above):
        facets.setdefault(tuple(np.flatnonzero(abs(heights[row]) < tolerance)), normals[row] * (1 if below[row] else -1))
    faces = [f for key in facets for f in _triangulate(points, list(key), facets[key])]
    used, faces = np.unique(np.array(faces), return_inverse=True)
    return points[used], faces.reshape(-1, 3)


def _triangulate(points, indices, normal):
    """Triangles of the convex polygon spanned by coplanar points, counter-clockwise about normal."""
    u = np.cross(normal, np.eye(3)[np.argmin(abs(normal))])
    u /= np.linalg.norm(u)
    flat = points[indices] @ np.array([u, np.cross(normal, u)]).T
    offset = flat - flat.mean(axis=0)
    ring = list(np.argsort(np.arctan2(offset[:, 1], offset[:, 0])))

    def turn(i, j, k):
        (ax, ay), (bx, by) = flat[j] - flat[i], flat[k] - flat[j]
        return (ax * by - ay * bx) / (np.hypot(ax, ay) * np.hypot(bx, by))

    corner = True
    while corner is not None:      # drop the points in the middle of straight edges
        corner = next((n for n in range(len(ring)) if turn(ring[n - 1], ring[n], ring[(n + 1) % len(ring)]) < 1e-4), None)
        if corner is not None:
            del ring[corner]
    triangles = []
    while len(ring) > 3:
        ears = [(ring[n - 1], ring[n], ring[(n + 1) % len(ring)]) for n in range(len(ring))]
        best = max(range(len(ring)), key=lambda n: smallest_angle(flat[list(ears[n])]))
        triangles.append([indices[i] for i in ears[best]])
        del ring[best]
    return triangles + [[indices[i] for i in ring]]


def smallest_angle(triangle):
    """Smallest angle of a triangle (3 points of any dimension), radians."""
    edges = triangle[[1, 2, 0]] - triangle
    edges = edges / np.linalg.norm(edges, axis=1)[:, None]
    return min(np.arccos(np.clip(-edges[i] @ edges[i - 1], -1, 1)) for i in range(3))


def is_closed_manifold(faces):
    """True when every directed edge occurs once and its reverse once."""
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forward = {tuple(e) for e in edges}
    return len(forward) == len(edges) and all((b, a) in forward for a, b in forward)


def edges(faces, values):
    """The edges (n, 2) of a closed mesh, and at each the values of its two faces (n, 2)."""
    ends = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    order = np.lexsort(ends.T)
    return ends[order[::2]], np.tile(values, 3)[order].reshape(-1, 2)


def volume(vertices, faces):
    """Signed volume: positive when the faces look outwards."""
    a, b, c = vertices[faces.T]
    return np.sum(a * np.cross(b, c)) / 6


def planes(vertices, faces):
    """Unit normals (m, 3) and offsets (m) of the faces."""
    a, b, c = vertices[faces.T]
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return normals, np.sum(normals * a, axis=1)


def sample(vertices, faces, spacing):
    """Regular barycentric samples of every face, about spacing apart, and the normals there."""
    normals, _ = planes(vertices, faces)
    points, directions = [], []
    for (a, b, c), normal in zip(vertices[faces], normals):
        n = int(np.ceil(max(np.linalg.norm(b - a), np.linalg.norm(c - b), np.linalg.norm(a - c)) / spacing))
        i, j = np.array([(i, j) for i in range(n + 1) for j in range(n + 1 - i)]).T[:, :, None] / n
        points.append(a + i * (b - a) + j * (c - a))
        directions.append(np.broadcast_to(normal, points[-1].shape))
    return np.vstack(points), np.vstack(directions)


def closest_on_triangle(p, a, b, c):
    """Closest points of triangles (a, b, c) to p; all arguments broadcast to (..., 3)."""
    def dot(x, y):
        return np.sum(x * y, axis=-1)

    def on_segment(u, v):
        t = np.clip(dot(p - u, v - u) / dot(v - u, v - u), 0, 1)
        return u + t[..., None] * (v - u)

    ab, ac, ap = b - a, c - a, p - a
    aa, ab_ac, cc, pa, pc = dot(ab, ab), dot(ab, ac), dot(ac, ac), dot(ap, ab), dot(ap, ac)
    det = aa * cc - ab_ac ** 2
    v, w = (cc * pa - ab_ac * pc) / det, (aa * pc - ab_ac * pa) / det
    inside = (v >= 0) & (w >= 0) & (v + w <= 1)
    best = a + v[..., None] * ab + w[..., None] * ac
    best_distance = np.where(inside, np.linalg.norm(best - p, axis=-1), np.inf)
    for q in (on_segment(a, b), on_segment(b, c), on_segment(c, a)):
        d = np.linalg.norm(q - p, axis=-1)
        nearer = d < best_distance
        best = np.where(nearer[..., None], q, best)
        best_distance = np.where(nearer, d, best_distance)
    return best, best_distance
