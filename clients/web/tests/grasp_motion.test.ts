import { readFileSync } from 'node:fs';

import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import type { Grasp, Pose } from '../src/api/types';
import { calcHandState, type HandState } from '../src/robot/grasp_motion';
import { toMatrix } from '../src/robot/pose';

const EXAMPLE = new URL('../../../schema/examples/Grasp.json', import.meta.url);
const grasp = JSON.parse(readFileSync(EXAMPLE, 'utf8')) as Grasp;

function expectAt({ X_OH }: HandState, pose: Pose): void {
  const gap = new Vector3().setFromMatrixPosition(X_OH).distanceTo(
    new Vector3().setFromMatrixPosition(toMatrix(pose)),
  );
  expect(gap).toBeLessThan(1e-9);
}

describe('the motion of a grasp', () => {
  it('starts open at the pre-grasp', () => {
    const state = calcHandState(grasp, 0);
    expectAt(state, grasp.pregrasp.X_OH);
    expect(state.joints).toEqual(grasp.pregrasp.joints);
  });

  it('arrives at X_OH still open', () => {
    const state = calcHandState(grasp, 0.5);
    expectAt(state, grasp.X_OH);
    expect(state.joints).toEqual(grasp.pregrasp.joints);
  });

  it('ends with exactly the joints of the grasp', () => {
    const state = calcHandState(grasp, 1);
    expectAt(state, grasp.X_OH);
    expect(state.joints).toBe(grasp.joints);
  });

  it('goes along the approach', () => {
    const way = new Vector3()
      .setFromMatrixPosition(calcHandState(grasp, 0.5).X_OH)
      .sub(new Vector3().setFromMatrixPosition(calcHandState(grasp, 0).X_OH));
    expect(way.length()).toBeCloseTo(grasp.pregrasp.distance, 9);
    expect(way.normalize().dot(new Vector3(...grasp.pregrasp.approach))).toBeCloseTo(1, 9);
  });
});
