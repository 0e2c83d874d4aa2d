"""Even, well-shaped triangles for a surface given by a field, cut into two parts by a plane. Needs numpy only.

Starts from a fine mesh of the surface. The vertices in the cut form rings that lie exactly in the plane; no edge
crosses it. Splitting, collapsing and flipping edges and moving vertices alternate until the edges have the wanted
lengths: that of their part, shorter where the surface is strongly curved. Positions are rounded to the precision
that is written, so that the result does not depend on the last bit of a machine's arithmetic.
"""
import numpy as np

import implicit
import mesh

DECIMALS = 4           # of positions and wanted lengths, millimetres
CHORD = 0.7            # longest edge as a share of the radius of curvature ...
SHORTEST = 0.45        # ... but no shorter than this share of the part's
GRADING = 0.35         # most by which the wanted length grows per length


def minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


class Surface:
    """A closed mesh that is changed edge by edge.

    point[v], wanted[v]: position and wanted edge length; face[f] = [a, b, c]; part[f]: 0 on the side of the plane
    to which its normal points, 1 on the other; fan[v]: the faces around a vertex.
    """

    def __init__(self, field, fine, plane, edges):
        self.field, self.origin, self.normal = field, np.array(plane[0], float), np.array(plane[1], float)
        self.normal /= np.linalg.norm(self.normal)
        self.edges = edges
        vertices, faces = fine
        step = np.linalg.norm(vertices[faces[0, 0]] - vertices[faces[0, 1]])
        vertices = self.project(self.project(vertices))
        near = abs(self.height(vertices)) < 0.3 * step
        vertices[near] = self.project_to_seam(vertices[near])
        self.point = [tuple(p) for p in vertices.tolist()]
        self.face = dict(enumerate(faces.tolist()))
        self.next_face = len(self.face)
        self.part, self.fan = dict.fromkeys(self.face, 0), [set() for _ in self.point]
        for f, corners in self.face.items():
            for v in corners:
                self.fan[v].add(f)
        self.wanted = [0.0] * len(self.point)
        self.cut(near)

    # The field and the plane

    def height(self, points):
        return (points - self.origin) @ self.normal

    def project(self, points):
        """One Newton step onto the surface."""
        g = implicit.gradient(self.field, points)
        return np.round(points - self.field(points)[:, None] * g / np.sum(g * g, axis=1)[:, None], DECIMALS)

    def project_to_seam(self, points):
        """Newton steps onto the curve of the surface in the plane."""
        for _ in range(4):
            g = implicit.gradient(self.field, points)
            g -= (g @ self.normal)[:, None] * self.normal
            points = points - self.field(points)[:, None] * g / np.sum(g * g, axis=1)[:, None]
            points = points - self.height(points)[:, None] * self.normal
        return np.round(points, DECIMALS)

    def cut(self, on_plane):
        """Splits the edges that cross the plane, and tells the parts of the faces."""
        height = [0.0 if n else h for h, n in zip(self.height(np.array(self.point)).tolist(), on_plane)]
        crossing = [(a, b) for a, b in self.all_edges() if height[a] * height[b] < 0]
        share = np.array([height[a] / (height[a] - height[b]) for a, b in crossing])[:, None]
        points = np.array(self.point)
        a, b = np.array(crossing, int).reshape(-1, 2).T
        for edge, point in zip(crossing, self.project_to_seam(points[a] + share * (points[b] - points[a])).tolist()):
            self.split(*edge, tuple(point))
            height.append(0.0)
        for f, corners in self.face.items():
            self.part[f] = int(sum(height[v] for v in corners) < 0)

    # Topology

    def all_edges(self):
        return sorted({(min(a, b), max(a, b)) for c in self.face.values() for a, b in zip(c, c[1:] + c[:1])})

    def shared(self, a, b):
        """The faces at an edge: none when there is no such edge."""
        return sorted(self.fan[a] & self.fan[b])

    def neighbours(self, v):
        return {w for f in self.fan[v] for w in self.face[f]} - {v}

    def in_seam(self, v):
        return len({self.part[f] for f in self.fan[v]}) == 2

    def add_face(self, corners, part):
        f = self.next_face
        self.next_face += 1
        self.face[f], self.part[f] = corners, part
        for v in corners:
            self.fan[v].add(f)

    def remove_face(self, f):
        for v in self.face.pop(f):
            self.fan[v].discard(f)
        return self.part.pop(f)

    def split(self, a, b, point):
        new = len(self.point)
        self.point.append(point)
        self.wanted.append((self.wanted[a] + self.wanted[b]) / 2)
        self.fan.append(set())
        for f in self.shared(a, b):
            corners = self.face[f]
            part = self.remove_face(f)
            self.add_face([new if v == a else v for v in corners], part)
            self.add_face([new if v == b else v for v in corners], part)

    def span(self, p, q):
        d = minus(p, q)
        return dot(d, d) ** 0.5

    def face_normal(self, corners):
        a, b, c = (self.point[v] for v in corners)
        return cross(minus(b, a), minus(c, a))

    def collapse(self, a, b, limit):
        """Joins a into b; refused when that changes the topology, the seam, folds, or makes an edge too long."""
        between = self.shared(a, b)
        if len(between) != 2:
            return
        seam = self.part[between[0]] != self.part[between[1]]
        if self.in_seam(a) and not seam:
            return
        point = self.point[b]
        if seam or not self.in_seam(b):
            point = tuple((p + q) / 2 for p, q in zip(self.point[a], point))
        if len(self.neighbours(a) & self.neighbours(b)) != 2 or min(len(self.fan[v]) for v in self.opposite(between, a, b)) < 4:
            return
        old = self.point[a], self.point[b]
        others = sorted((self.fan[a] | self.fan[b]) - set(between))
        before = [self.face_normal(self.face[f]) for f in others]
        self.point[a] = self.point[b] = point
        after = [self.face_normal(self.face[f]) for f in others]
        good = all(dot(m, n) > 0.7 * (dot(m, m) * dot(n, n)) ** 0.5 for m, n in zip(before, after))
        far = max(self.span(point, self.point[v]) for v in self.neighbours(a) | self.neighbours(b))
        if not good or far > limit:
            self.point[a], self.point[b] = old
            return
        for f in between:
            self.remove_face(f)
        for f in sorted(self.fan[a]):
            corners = self.face[f]
            part = self.remove_face(f)
            self.add_face([b if v == a else v for v in corners], part)

    def opposite(self, faces, a, b):
        return [v for f in faces for v in self.face[f] if v not in (a, b)]

    def flip(self, a, b):
        """Turns an edge when that makes the smallest angle larger and folds nothing."""
        between = self.shared(a, b)
        if len(between) != 2 or self.part[between[0]] != self.part[between[1]]:
            return
        i = self.face[between[0]].index(a)
        if self.face[between[0]][(i + 1) % 3] != b:
            between.reverse()
        (c,), (d,) = (self.opposite([f], a, b) for f in between)      # (a, b, c) and (b, a, d)
        if self.shared(c, d) or min(len(self.fan[a]), len(self.fan[b])) < 5:
            return
        old, new = ([a, b, c], [b, a, d]), ([a, d, c], [d, b, c])
        facing = [self.face_normal(corners) for corners in old + new]
        if min(dot(m, n) - 0.8 * (dot(m, m) * dot(n, n)) ** 0.5 for m in facing[:2] for n in facing[2:]) < 0:
            return
        if min(map(self.sharpness, new)) > min(map(self.sharpness, old)) + 1e-6:
            part = [self.remove_face(f) for f in between][0]
            for corners in new:
                self.add_face(corners, part)

    def sharpness(self, corners):
        """Grows with the smallest angle of a triangle: its height over its longest edge."""
        a, b, c = (self.point[v] for v in corners)
        n = cross(minus(b, a), minus(c, a))
        return dot(n, n) ** 0.5 / max(self.span(a, b), self.span(b, c), self.span(c, a)) ** 2

    # The rounds

    def arrays(self):
        """The vertices in use, the edges, faces and parts by their places among those."""
        used = [v for v in range(len(self.point)) if self.fan[v]]
        place = dict(zip(used, range(len(used))))
        faces = np.array([[place[v] for v in self.face[f]] for f in sorted(self.face)])
        parts = np.array([self.part[f] for f in sorted(self.face)])
        return used, np.array([self.point[v] for v in used]), faces, parts

    def measure(self):
        """Wanted edge length at every vertex."""
        used, points, faces, parts = self.arrays()
        edges, _ = mesh.edges(faces, parts)
        lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
        normals = implicit.normals(self.field, points)
        turn = np.linalg.norm(normals[edges[:, 0]] - normals[edges[:, 1]], axis=1)
        part = np.full(len(points), np.inf)
        for k in range(3):
            np.minimum.at(part, faces[:, k], np.array(self.edges, float)[parts])
        wanted = part.copy()
        for k in (0, 1):
            np.minimum.at(wanted, edges[:, k], CHORD * lengths / np.maximum(turn, 1e-6))
        wanted = np.maximum(wanted, SHORTEST * part)
        for _ in range(20):
            for k in (0, 1):
                np.minimum.at(wanted, edges[:, k], wanted[edges[:, 1 - k]] + GRADING * lengths)
        for v, length in zip(used, np.round(wanted, DECIMALS).tolist()):
            self.wanted[v] = length

    def smooth(self):
        """Moves vertices towards the centre of their neighbours, along the surface; those in the seam along it."""
        used, points, faces, parts = self.arrays()
        pairs, sides = mesh.edges(faces, parts)
        seam_pairs = pairs[sides[:, 0] != sides[:, 1]]
        seam = np.unique(seam_pairs)

        def mean(pairs):
            total, count = np.zeros_like(points), np.zeros(len(points))
            for k in (0, 1):
                np.add.at(total, pairs[:, k], points[pairs[:, 1 - k]])
                np.add.at(count, pairs[:, k], 1)
            return total / np.maximum(count, 1)[:, None]

        move = mean(pairs) - points
        move[seam] = mean(seam_pairs)[seam] - points[seam]
        normals = implicit.normals(self.field, points)
        move -= np.sum(move * normals, axis=1)[:, None] * normals
        moved = points + 0.6 * move
        moved = self.project(self.project(moved))
        moved[seam] = self.project_to_seam(moved[seam])
        for v, p in zip(used, moved.tolist()):
            self.point[v] = tuple(p)

    def sizes(self):
        """Edges as (length over wanted length, a, b)."""
        for a, b in self.all_edges():
            yield self.span(self.point[a], self.point[b]) / ((self.wanted[a] + self.wanted[b]) / 2), a, b

    def improve(self, rounds=8):
        for turn in range(rounds):
            self.measure()
            for size, a, b in sorted(self.sizes(), reverse=True):
                if size > 4 / 3 and self.shared(a, b):
                    self.split(a, b, tuple((p + q) / 2 for p, q in zip(self.point[a], self.point[b])))
            for _ in range(3 if turn == 0 else 1):
                for _, a, b in sorted(s for s in self.sizes() if s[0] < 4 / 5):
                    wanted = (self.wanted[a] + self.wanted[b]) / 2
                    if self.shared(a, b) and self.span(self.point[a], self.point[b]) < 4 / 5 * wanted:
                        if self.in_seam(a) and not self.in_seam(b):
                            a, b = b, a
                        self.collapse(a, b, 4 / 3 * wanted)
            for _ in range(2):
                for a, b in self.all_edges():
                    self.flip(a, b)
                self.smooth()
        _, points, faces, parts = self.arrays()
        return points, faces, parts
