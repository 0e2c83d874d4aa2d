// @vitest-environment jsdom
/** The hand that is drawn touches what the server says that it touches. */
import { type BufferGeometry, Matrix4, Triangle, Vector3 } from 'three';
import { beforeAll, describe, expect, inject, it, vi } from 'vitest';

import type { Grasp } from '../../clients/web/src/api/types';
import { calcHandState } from '../../clients/web/src/robot/grasp_motion';
import { type HandModel, loadHandModel } from '../../clients/web/src/robot/hand_model';
import { queryGrasps } from './support/seed';

/** A contact is within the server's contact tolerance of 0.5 mm; the rest is for
 * contacts of a patch, which lie on the object. */
const TOLERANCE = 0.002; // m
const NUM_GRASPS = 10;

function calcDistance(p: Vector3, geometry: BufferGeometry): number {
  const corners = geometry.getAttribute('position');
  const triangle = new Triangle();
  const closest = new Vector3();
  let least = Infinity;
  for (let i = 0; i < corners.count; i += 3) {
    triangle.setFromAttributeAndIndices(corners, i, i + 1, i + 2);
    least = Math.min(least, triangle.closestPointToPoint(p, closest).distanceTo(p));
  }
  return least;
}

describe('a hand drawn at a grasp', () => {
  let hand: HandModel;
  let grasps: readonly Grasp[];
  beforeAll(async () => {
    const url = inject('url');
    const ask = globalThis.fetch;
    vi.stubGlobal('fetch', (path: string) => ask(new URL(path, url)));
    hand = await loadHandModel('barrett-bh8-280');
    vi.unstubAllGlobals();
    grasps = (await queryGrasps(url, `stage=assembly&limit=${NUM_GRASPS}`)).items;
  });

  it('has each contact on the link that is said to touch', () => {
    expect(grasps.length).toBeGreaterThan(0);
    for (const grasp of grasps) {
      const poses = hand.calcLinkPoses(calcHandState(grasp, 1));
      for (const { link, p_O } of grasp.contacts) {
        const shape = hand.shapes.find(({ links }) => links.includes(link));
        const X_OL = poses.get(link) ?? new Matrix4();
        const p_L = new Vector3(...p_O).applyMatrix4(X_OL.clone().invert());
        if (!shape) throw new Error(`${link} has no shape`);
        expect(calcDistance(p_L, shape.geometry), `${grasp.id} ${link}`).toBeLessThan(TOLERANCE);
      }
    }
  });
});
