// @vitest-environment jsdom
import { BoxGeometry, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import urdf from '../../../data/hands/barrett-bh8-280/hand.urdf?raw';
import { findBones } from '../src/robot/bones';
import { parseUrdf } from '../src/robot/hand_model';

describe('the skeleton of a hand', () => {
  const { links } = parseUrdf(urdf);
  const bonesOf = (name: string, shape?: BoxGeometry): readonly Vector3[] => {
    const link = links[name];
    if (!link) throw new Error(`There is no link ${name}.`);
    return findBones(link, shape);
  };

  it('leads from the base to the joint of each finger', () => {
    expect(bonesOf('bh_base_link').map((end) => end.toArray())).toEqual([
      [-0.025, 0, 0.0415], [0.025, 0, 0.0415], [0, 0.05, 0.0754],
    ]);
  });

  it('ends at the farthest point of the last link', () => {
    const [tip] = bonesOf('bh_finger_13_link', new BoxGeometry(2, 2, 2).translate(1, 0, 0));
    expect(tip?.x).toBe(2);
    expect(tip?.length()).toBeCloseTo(Math.sqrt(6), 12);
  });

  it('has no bone where nothing is', () => {
    expect(bonesOf('bh_finger_13_link')).toEqual([]);
  });
});
