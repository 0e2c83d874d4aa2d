import { type Box3, Vector3 } from 'three';

import type { Grasp } from '../../api/types';
import { toVector } from '../../robot/pose';

/** Room around an object and around the base of a hand, m. */
const ROOM = 0.04;
/** Room for hands on all sides of an object, m. */
export const HAND_ROOM = 0.09;

/** The object and the way of the hand. */
export function makeBoxOfMotion(box_O: Box3, { X_OH, pregrasp }: Grasp): Box3 {
  return box_O
    .clone()
    .expandByPoint(toVector(X_OH.position))
    .expandByPoint(toVector(pregrasp.X_OH.position))
    .expandByScalar(ROOM);
}

/** So that the example, which stands along x, is beside the object, from the side
 * where the hand does not hide it. */
export function chooseDirectionAcross({ pregrasp: { approach } }: Grasp): Vector3 {
  return new Vector3(0, approach[1] > 0.2 ? 1 : -1, 0.4).normalize();
}

/** From the side, so that hand and object stand beside each other. */
export function chooseDirection(grasp: Grasp): Vector3 {
  const [x, y] = grasp.pregrasp.approach;
  const side = Math.hypot(x, y) > 0.2 ? new Vector3(y, -x, 0).normalize() : new Vector3(0.4, -1, 0).normalize();
  return side.setZ(0.45).normalize();
}
