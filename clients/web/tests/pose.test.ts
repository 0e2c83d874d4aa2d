import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import type { Pose } from '../src/api/types';
import { interpolateJoints, interpolatePoses, toMatrix, toSimilarity } from '../src/robot/pose';

const HALF = Math.SQRT1_2;
/** A quarter turn about z at (1, 2, 3) m. */
const X_AB: Pose = { position: [1, 2, 3], orientation: { x: 0, y: 0, z: HALF, w: HALF } };

function expectNear(actual: Vector3, expected: readonly number[]): void {
  actual.toArray().forEach((value, axis) => {
    expect(value).toBeCloseTo(expected[axis] ?? Number.NaN, 12);
  });
}

describe('a pose of the contract', () => {
  it('turns by its quaternion, w last in none of its arrays, then moves', () => {
    expectNear(new Vector3(1, 0, 0).applyMatrix4(toMatrix(X_AB)), [1, 3, 3]);
    expectNear(new Vector3(0, 0, 5).applyMatrix4(toMatrix(X_AB)), [1, 2, 8]);
  });

  it('is not mistaken about x and w', () => {
    const X: Pose = { position: [0, 0, 0], orientation: { x: 1, y: 0, z: 0, w: 0 } };
    expectNear(new Vector3(1, 2, 3).applyMatrix4(toMatrix(X)), [1, -2, -3]);
  });

  it('of a similarity scales the example before it is moved', () => {
    expectNear(new Vector3(1, 0, 0).applyMatrix4(toSimilarity(X_AB, 2)), [1, 4, 3]);
  });

  it('halfway is halfway in place and angle', () => {
    const start: Pose = { position: [0, 0, 0], orientation: { x: 0, y: 0, z: 0, w: 1 } };
    const X = interpolatePoses(start, X_AB, 0.5);
    expectNear(new Vector3(0, 0, 0).applyMatrix4(X), [0.5, 1, 1.5]);
    expectNear(new Vector3(1, 0, 0).applyMatrix4(X), [0.5 + HALF, 1 + HALF, 1.5]);
  });
});

describe('joints', () => {
  it('are interpolated by name, whatever their order', () => {
    expect(interpolateJoints({ a: 0, b: 1 }, { b: 3, a: 1 }, 0.5)).toEqual({ a: 0.5, b: 2 });
  });

  it('that only one end has keep their value', () => {
    expect(interpolateJoints({ a: 1 }, { b: 2 }, 0.5)).toEqual({ a: 1, b: 2 });
  });
});
