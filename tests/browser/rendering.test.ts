/** What it costs to draw a big scene, by the processor alone. Times are printed,
 * not judged. */
import type { Page } from 'playwright-core';
import { describe, expect, inject, it } from 'vitest';

import type { Grasp } from '../../clients/web/src/api/types';
import { makeTorus } from './support/torus';
import { queryGrasps } from './support/seed';
import { useVisitors } from './support/visitor';

const enter = useVisitors();
const NUM_GRASPS = 200;
const NUM_FRAMES = 10;

async function uploadTorus(): Promise<string> {
  const form = new FormData();
  form.append('mesh', new Blob([makeTorus(250, 100)]), 'torus.obj');
  const response = await fetch(`${inject('url')}/v1/objects`, { method: 'POST', body: form });
  const { id, triangles } = (await response.json()) as { id: string; triangles: number };
  expect(triangles).toBe(50_000);
  return id;
}

/** Real grasps, as often as it takes, as if they were on the object. */
async function makeGrasps(object: string): Promise<Grasp[]> {
  const { items } = await queryGrasps(inject('url'), `limit=${NUM_GRASPS}`);
  return Array.from({ length: NUM_GRASPS }, (_, i) => {
    const grasp = items[i % items.length];
    if (!grasp) throw new Error('There is no grasp to draw.');
    return { ...grasp, object, id: i.toString(16).padStart(32, '0') };
  });
}

const readStatistics = async (page: Page): Promise<number[]> =>
  ((await page.locator('.viewport-statistics').textContent()) ?? '')
    .replaceAll(',', '')
    .match(/[\d.]+/g)
    ?.map(Number) ?? [];

describe('a mesh of 50,000 triangles with 200 grasps', () => {
  it('is drawn in few calls', async () => {
    const object = await uploadTorus();
    const grasps = await makeGrasps(object);
    const visitor = await enter();
    const { page } = visitor;
    await page.route('**/v1/grasps?*', (route) => route.fulfill({ json: { items: grasps, next_cursor: null } }));
    await visitor.visit(`/?view=grasps&object=${object}&show=all&stats=1`);
    await page.getByText('200 grasps').first().waitFor();
    await visitor.settle();
    const times: number[] = [];
    for (let frame = 0; frame < NUM_FRAMES; ++frame) {
      await page.getByRole('button', { name: 'Measure' }).click();
      times.push((await readStatistics(page))[2] ?? Number.NaN);
    }
    const [calls = Number.NaN, triangles = Number.NaN] = await readStatistics(page);
    const median = times.sort((a, b) => a - b)[NUM_FRAMES / 2] ?? Number.NaN;
    console.log(`${calls} draw calls, ${triangles} triangles, ${median} ms per frame (median of ${NUM_FRAMES})`);
    await visitor.picture('rendering');
    expect(triangles).toBeGreaterThan(50_000);
    expect(calls).toBeLessThan(30);
  });
});

describe('the start page', () => {
  it('is there', async () => {
    const visitor = await enter();
    const start = performance.now();
    await visitor.page.goto('/');
    await visitor.page.locator('.card-title').first().waitFor();
    const categories = performance.now() - start;
    await visitor.page.locator('.thumbnail.is-drawn').first().waitFor();
    const pictures = performance.now() - start;
    console.log(`categories after ${categories.toFixed(0)} ms, first thumbnail after ${pictures.toFixed(0)} ms`);
  });
});
