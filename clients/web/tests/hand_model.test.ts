// @vitest-environment jsdom
import { Matrix4, Vector3 } from 'three';
import { beforeAll, describe, expect, it } from 'vitest';

import urdf from '../../../data/hands/barrett-bh8-280/hand.urdf?raw';
import { HandModel, parseUrdf } from '../src/robot/hand_model';

/** The fingertip's pad in the distal link: 40 degrees bent, then out to the pad. */
const p_LT = new Vector3(0.05, 0.0095, 0).applyMatrix4(new Matrix4().makeRotationZ(0.698132));

/** Spread, J2 and J3 of fingers 1 to 3, and where the pads then are in frame H:
 * the hand's published kinematics, computed apart from the URDF. In the last two
 * the fingers have broken away: J3 is more than a third of J2. */
const VECTORS = [
  [0, [0, 0, 0], [0, 0, 0],
    [[-0.025, -0.152132, 0.117817], [0.025, -0.152132, 0.117817], [0, 0.152132, 0.117817]]],
  [0.3, [0.4, 0.9, 1.4], [0.133333, 0.3, 0.466667],
    [[-0.060738, -0.11553, 0.155709], [0.044519, -0.063101, 0.176338], [0, 0.011839, 0.164132]]],
  [1.2, [0.9, 1.1, 0.7], [0.5, 0.45, 0.8],
    [[-0.078827, -0.020927, 0.170474], [0.062571, -0.014607, 0.172097], [0, 0.064517, 0.157652]]],
  [2.5, [0.1, 2, 1], [0.3, 0.7, 0.4],
    [[-0.104951, 0.107026, 0.13421], [0.008372, -0.02226, 0.115868], [0, 0.051891, 0.174297]]],
] as const;

function nameJoints(spread: number, j2: readonly number[], j3: readonly number[]) {
  const joints: Record<string, number> = { bh_j11_joint: spread, bh_j21_joint: spread };
  for (const finger of [1, 2, 3]) {
    joints[`bh_j${finger}2_joint`] = j2[finger - 1] ?? Number.NaN;
    joints[`bh_j${finger}3_joint`] = j3[finger - 1] ?? Number.NaN;
  }
  return joints;
}

describe('the Barrett hand of the URDF', () => {
  let hand: HandModel;
  beforeAll(() => {
    hand = new HandModel(parseUrdf(urdf), []);
  });

  const findPad = (joints: Record<string, number>, finger: number, X_OH = new Matrix4()): Vector3 => {
    const X_OL = hand.calcLinkPoses({ X_OH, joints }).get(`bh_finger_${finger}3_link`);
    if (!X_OL) throw new Error(`There is no finger ${finger}.`);
    return p_LT.clone().applyMatrix4(X_OL);
  };

  it.each(VECTORS)('has its pads where they are published to be: spread %d', (spread, j2, j3, pads) => {
    const joints = nameJoints(spread, j2, j3);
    pads.forEach(([x, y, z], index) => {
      expect(findPad(joints, index + 1).distanceTo(new Vector3(x, y, z))).toBeLessThan(1e-5);
    });
  });

  it('stands the same in whatever order its joints are named', () => {
    const joints = nameJoints(1.2, [0.9, 1.1, 0.7], [0.5, 0.45, 0.8]);
    const reversed = Object.fromEntries(Object.entries(joints).reverse());
    const pads = [1, 2, 3].map((finger) => findPad(joints, finger));
    pads.forEach((pad, index) => {
      expect(findPad(reversed, index + 1).distanceTo(pad)).toBeLessThan(1e-12);
    });
  });

  it('moves with X_OH', () => {
    const joints = nameJoints(0, [0, 0, 0], [0, 0, 0]);
    const X_OH = new Matrix4().makeTranslation(1, 2, 3);
    const moved = findPad(joints, 3, X_OH).sub(findPad(joints, 3));
    expect(moved.distanceTo(new Vector3(1, 2, 3))).toBeLessThan(1e-12);
  });
});
