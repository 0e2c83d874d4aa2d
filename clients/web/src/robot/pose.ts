import { Matrix4, Quaternion, Vector3 } from 'three';

import type { JointPositions, Point, Pose } from '../api/types';

export const toVector = ([x, y, z]: Point): Vector3 => new Vector3(x, y, z);

/** {x, y, z, w} by name: no array whose order could be mistaken. */
function toQuaternion({ orientation: { x, y, z, w } }: Pose): Quaternion {
  return new Quaternion(x, y, z, w);
}

/** X_AB as the matrix that takes p_B to p_A. */
export function toMatrix(X_AB: Pose): Matrix4 {
  return new Matrix4().compose(toVector(X_AB.position), toQuaternion(X_AB), new Vector3(1, 1, 1));
}

/** X_NE of a similarity: p_N = X_NE (scale p_E). */
export function toSimilarity(X_NE: Pose, scale: number): Matrix4 {
  return toMatrix(X_NE).scale(new Vector3(scale, scale, scale));
}

/** From `from` (t = 0) to `to` (t = 1), straight and about one axis. */
export function interpolatePoses(from: Pose, to: Pose, t: number): Matrix4 {
  const position = toVector(from.position).lerp(toVector(to.position), t);
  const rotation = toQuaternion(from).slerp(toQuaternion(to), t);
  return new Matrix4().compose(position, rotation, new Vector3(1, 1, 1));
}

/** Joint by joint, by name; a joint that only one of both has keeps its value. */
export function interpolateJoints(
  from: JointPositions,
  to: JointPositions,
  t: number,
): JointPositions {
  const joints: Record<string, number> = { ...from };
  for (const [name, end] of Object.entries(to)) {
    const start = from[name] ?? end;
    joints[name] = start + t * (end - start);
  }
  return joints;
}
