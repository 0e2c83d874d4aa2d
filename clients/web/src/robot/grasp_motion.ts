import type { Matrix4 } from 'three';

import type { Grasp, JointPositions } from '../api/types';
import { interpolateJoints, interpolatePoses, toMatrix } from './pose';

/** Where a hand is and how its joints stand. */
export interface HandState {
  readonly X_OH: Matrix4;
  readonly joints: JointPositions;
}

/** Share of the motion in which the hand moves; in the rest it closes. */
const APPROACH_SHARE = 0.5;

/** The grasp as it is executed: at progress 0 the open hand at the pre-grasp,
 * then straight to X_OH, then all fingers closing until, at progress 1, they
 * hold. Joints move in proportion, since the pre-grasp is timed so that fingers
 * of equal speed meet the object together. */
export function calcHandState(grasp: Grasp, progress: number): HandState {
  const approached = Math.min(progress / APPROACH_SHARE, 1);
  const closed = Math.max((progress - APPROACH_SHARE) / (1 - APPROACH_SHARE), 0);
  if (closed >= 1) return { X_OH: toMatrix(grasp.X_OH), joints: grasp.joints };
  return {
    X_OH: interpolatePoses(grasp.pregrasp.X_OH, grasp.X_OH, approached),
    joints: interpolateJoints(grasp.pregrasp.joints, grasp.joints, closed),
  };
}
