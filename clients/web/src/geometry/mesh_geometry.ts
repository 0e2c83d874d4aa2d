import { BufferAttribute, BufferGeometry } from 'three';

import { calcCreasedNormals } from './creased_normals';
import type { TriangleMesh } from './read_obj';

/** Faces that are drawn alike. */
export type FaceGroups = readonly (readonly number[])[];

/** A geometry for three. With groups, faces are sorted by group, each of which
 * becomes one of the geometry's and takes the material of the same index; faces
 * of no group are not drawn. */
export function makeMeshGeometry(mesh: TriangleMesh, groups?: FaceGroups): BufferGeometry {
  const normals = calcCreasedNormals(mesh);
  const order = groups ? groups.flat() : Array.from({ length: mesh.triangles.length / 3 }, (_, f) => f);
  const positions = new Float32Array(order.length * 9);
  const sortedNormals = new Float32Array(order.length * 9);
  order.forEach((face, place) => {
    for (let k = 0; k < 3; ++k) {
      const vertex = mesh.triangles[3 * face + k] ?? 0;
      positions.set(mesh.positions.subarray(3 * vertex, 3 * vertex + 3), 9 * place + 3 * k);
    }
    sortedNormals.set(normals.subarray(9 * face, 9 * face + 9), 9 * place);
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(sortedNormals, 3));
  let start = 0;
  groups?.forEach((faces, material) => {
    geometry.addGroup(3 * start, 3 * faces.length, material);
    start += faces.length;
  });
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  return geometry;
}
