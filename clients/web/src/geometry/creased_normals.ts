import type { TriangleMesh } from './read_obj';

/** Edges sharper than this stay edges: rims and corners look crisp, walls round. */
const CREASE_ANGLE = 0.7;

/** Outward unit normals of all corners, three per triangle, x y z after one
 * another: each the mean, weighted by area, of the faces around the vertex that
 * lie within the crease angle of the corner's own face. */
export function calcCreasedNormals(
  { positions, triangles }: TriangleMesh,
  creaseAngle = CREASE_ANGLE,
): Float32Array {
  const faces = calcFaceNormals(positions, triangles);
  const { starts, corners } = groupCornersByVertex(triangles, positions.length / 3);
  const normals = new Float32Array(triangles.length * 3);
  const least = Math.cos(creaseAngle);
  for (let corner = 0; corner < triangles.length; ++corner) {
    const own = Math.floor(corner / 3);
    const vertex = triangles[corner] ?? 0;
    let [x, y, z] = [0, 0, 0];
    for (let i = starts[vertex] ?? 0; i < (starts[vertex + 1] ?? 0); ++i) {
      const face = Math.floor((corners[i] ?? 0) / 3);
      if (face !== own && dot(faces.units, own, face) < least) continue;
      const weight = faces.areas[face] ?? 0;
      x += weight * (faces.units[3 * face] ?? 0);
      y += weight * (faces.units[3 * face + 1] ?? 0);
      z += weight * (faces.units[3 * face + 2] ?? 0);
    }
    const length = Math.hypot(x, y, z) || 1;
    normals.set([x / length, y / length, z / length], 3 * corner);
  }
  return normals;
}

function dot(vectors: Float32Array, a: number, b: number): number {
  let sum = 0;
  for (let k = 0; k < 3; ++k) sum += (vectors[3 * a + k] ?? 0) * (vectors[3 * b + k] ?? 0);
  return sum;
}

function calcFaceNormals(positions: Float32Array, triangles: Uint32Array) {
  const numFaces = triangles.length / 3;
  const units = new Float32Array(3 * numFaces);
  const areas = new Float32Array(numFaces);
  const at = (corner: number, axis: number): number =>
    positions[3 * (triangles[corner] ?? 0) + axis] ?? 0;
  for (let f = 0; f < numFaces; ++f) {
    const u = [0, 1, 2].map((k) => at(3 * f + 1, k) - at(3 * f, k));
    const v = [0, 1, 2].map((k) => at(3 * f + 2, k) - at(3 * f, k));
    const [ux = 0, uy = 0, uz = 0] = u;
    const [vx = 0, vy = 0, vz = 0] = v;
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const length = Math.hypot(x, y, z);
    areas[f] = length / 2;
    if (length > 0) units.set([x / length, y / length, z / length], 3 * f);
  }
  return { units, areas };
}

/** The corners at vertex v are corners[starts[v] … starts[v + 1]). */
function groupCornersByVertex(triangles: Uint32Array, numVertices: number) {
  const starts = new Uint32Array(numVertices + 1);
  for (const vertex of triangles) starts[vertex + 1] = (starts[vertex + 1] ?? 0) + 1;
  for (let v = 0; v < numVertices; ++v) starts[v + 1] = (starts[v + 1] ?? 0) + (starts[v] ?? 0);
  const next = starts.slice();
  const corners = new Uint32Array(triangles.length);
  triangles.forEach((vertex, corner) => {
    const place = next[vertex] ?? 0;
    corners[place] = corner;
    next[vertex] = place + 1;
  });
  return { starts, corners };
}
