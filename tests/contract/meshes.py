"""Small meshes, good and bad, as the bytes of files."""

import struct

# Corners by bits x, y, z; faces turn counter-clockwise seen from outside.
BOX_FACES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
             (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]


def box_vertices(x, y, z):
    return [((k & 1) * x, (k >> 1 & 1) * y, (k >> 2 & 1) * z)
            for k in range(8)]


def obj(vertices, faces):
    lines = [f"v {x} {y} {z}" for x, y, z in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    return ("\n".join(lines) + "\n").encode()


def box_obj(x, y, z):
    """A closed box, sides in the file's unit."""
    return obj(box_vertices(x, y, z), BOX_FACES)


def grid_box(x, y, z, cells):
    """A closed box whose sides are cut into cells x cells squares."""
    index, vertices, faces = {}, [], []

    def vertex(p):
        if p not in index:
            index[p] = len(vertices)
            vertices.append(tuple(s * c / cells for s, c in zip((x, y, z), p)))
        return index[p]

    for axis in range(3):
        for side in (0, cells):
            for i in range(cells):
                for j in range(cells):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        p = [0, 0, 0]
                        p[axis] = side
                        p[(axis + 1) % 3] = i + di
                        p[(axis + 2) % 3] = j + dj
                        corners.append(vertex(tuple(p)))
                    if side == 0:
                        corners.reverse()
                    a, b, c, d = corners
                    faces += [(a, b, c), (a, c, d)]
    return vertices, faces


def box_stl(x, y, z):
    """The box as binary STL."""
    v = box_vertices(x, y, z)
    out = b"\0" * 80 + struct.pack("<I", len(BOX_FACES))
    for face in BOX_FACES:
        out += struct.pack("<3f", 0, 0, 0)
        for i in face:
            out += struct.pack("<3f", *v[i])
        out += b"\0\0"
    return out


def unusable():
    """Yields (name, bytes, format) of what no mesh can be made of."""
    good = box_obj(0.05, 0.05, 0.05)
    yield "one line", b"hello\n", "obj"
    yield "not a mesh", bytes(range(256)) * 8, "stl"
    yield "truncated STL", box_stl(0.05, 0.05, 0.05)[:200], "stl"
    yield "wrong format", good, "ply"
    yield "NaN", good.replace(b"v 0.05 0.0 0.0", b"v nan 0.0 0.0").replace(
        b"v 0.05 0 0", b"v nan 0 0"), "obj"
    yield "infinite", good.replace(b"v 0.05 0", b"v 1e999 0"), "obj"
    yield "index out of range", good + b"f 1 2 99\n", "obj"
    yield "only vertices", b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\n", "obj"
    yield "coplanar", b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n", "obj"
    yield "zero area", b"v 0 0 0\nv 0.1 0 0\nv 0.2 0 0\nf 1 2 3\n", "obj"
    header = ("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000"
              "\nproperty float x\nproperty float y\nproperty float z\n"
              "element face 4000000000\nproperty list uchar int vertex_indices"
              "\nend_header\n")
    yield "PLY that lies", header.encode(), "ply"
