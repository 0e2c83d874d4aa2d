import { describe, expect, it } from 'vitest';

import { calcCreasedNormals } from '../src/geometry/creased_normals';
import { makeMeshGeometry } from '../src/geometry/mesh_geometry';
import { readObj } from '../src/geometry/read_obj';

/** A corner of a cube: three faces at right angles, sharing a vertex. */
const CORNER = `
# metres
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
`;

describe('an OBJ', () => {
  it('keeps vertices, faces and the order of both', () => {
    const { positions, triangles } = readObj(CORNER);
    expect([...positions]).toEqual([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]);
    expect([...triangles]).toEqual([0, 2, 1, 0, 1, 3, 0, 3, 2]);
  });

  it('may have textures, normals, and count from the end', () => {
    const { triangles } = readObj('v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2//2 -1');
    expect([...triangles]).toEqual([0, 1, 2]);
  });

  it('has its polygons cut into fans', () => {
    const { triangles } = readObj('v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4');
    expect([...triangles]).toEqual([0, 1, 2, 0, 2, 3]);
  });

  it('that refers to a vertex that it lacks is refused', () => {
    expect(() => readObj('v 0 0 0\nf 1 2 3')).toThrow(RangeError);
  });
});

describe('normals', () => {
  it('stay apart at a sharp edge and point out', () => {
    const normals = calcCreasedNormals(readObj(CORNER));
    const cornersAtOrigin = [0, 3, 6].map((corner) => [...normals.slice(3 * corner, 3 * corner + 3)]);
    expect(cornersAtOrigin).toEqual([[0, 0, -1], [0, -1, 0], [-1, 0, 0]].map((n) => n.map((x) => x + 0)));
  });

  it('are shared across a blunt one', () => {
    const normals = calcCreasedNormals(readObj(CORNER), Math.PI);
    const third = -1 / Math.sqrt(3);
    for (const corner of [0, 3, 6]) {
      normals.slice(3 * corner, 3 * corner + 3).forEach((x) => {
        expect(x).toBeCloseTo(third, 6);
      });
    }
  });
});

describe('a geometry with groups', () => {
  it('has the faces of each in a range of its own', () => {
    const geometry = makeMeshGeometry(readObj(CORNER), [[2], [0, 1]]);
    expect(geometry.groups).toEqual([
      { start: 0, count: 3, materialIndex: 0 },
      { start: 3, count: 6, materialIndex: 1 },
    ]);
    // Face 2 comes first: (0 0 0) (0 0 1) (0 1 0).
    expect([...geometry.getAttribute('position').array.slice(0, 9)]).toEqual([0, 0, 0, 0, 0, 1, 0, 1, 0]);
  });
});
