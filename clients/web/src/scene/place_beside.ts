import { type Box3, Matrix4 } from 'three';

import type { Pose } from '../api/types';
import { toMatrix } from '../robot/pose';

/** Free room between both, m: a hand on each must fit in. */
const GAP = 0.2;

/** X_OE for showing the example E left of the object O (towards -x) on the same
 * floor: turned as X_NE turns it, so that what is mapped to each other looks
 * alike. */
export function placeBeside(box_O: Box3, box_E: Box3, X_NE: Pose): Matrix4 {
  const turned = new Matrix4().extractRotation(toMatrix(X_NE));
  const box = box_E.clone().applyMatrix4(turned);
  return turned.premultiply(
    new Matrix4().makeTranslation(
      box_O.min.x - GAP - box.max.x,
      (box_O.min.y + box_O.max.y - box.min.y - box.max.y) / 2,
      box_O.min.z - box.min.z,
    ),
  );
}
