/** A triangle mesh, indexed; positions are x y z after one another, in metres. */
export interface TriangleMesh {
  readonly positions: Float32Array;
  /** Three vertices per triangle, counter-clockwise seen from outside. */
  readonly triangles: Uint32Array;
}

/** Reads the vertices and faces of a Wavefront OBJ and nothing else of it.
 *
 * The server writes objects and hands as plain OBJ. three's OBJLoader would
 * give up the indices, and with them the order of the faces, which is what a
 * part's `faces` refer to. Polygons become fans. */
export function readObj(text: string): TriangleMesh {
  const positions: number[] = [];
  const triangles: number[] = [];
  for (const line of text.split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') {
      positions.push(Number(words[1]), Number(words[2]), Number(words[3]));
    } else if (words[0] === 'f') {
      const corners = words.slice(1).map((word) => readVertexIndex(word, positions.length / 3));
      const [first] = corners;
      for (let k = 1; k + 1 < corners.length; ++k) {
        triangles.push(first ?? 0, corners[k] ?? 0, corners[k + 1] ?? 0);
      }
    }
  }
  return { positions: Float32Array.from(positions), triangles: Uint32Array.from(triangles) };
}

/** `7`, `7/1/3`, or `-1` for the last vertex so far; counted from 0 afterwards. */
function readVertexIndex(word: string, numVertices: number): number {
  const index = Number.parseInt(word, 10);
  const vertex = index < 0 ? numVertices + index : index - 1;
  if (!(vertex >= 0 && vertex < numVertices)) {
    throw new RangeError(`An OBJ face refers to vertex ${word} of ${numVertices}.`);
  }
  return vertex;
}
