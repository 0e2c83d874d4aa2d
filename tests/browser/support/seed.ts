import { readFileSync } from 'node:fs';
import { join } from 'node:path';

import type { components } from '../../../clients/web/src/api/schema';
import { requirePath } from './graspdb';

type Schemas = components['schemas'];

/** So little that it takes seconds, and enough for dozens of grasps of a body. */
const QUICK = {
  active_learning: { seed_samples: 1500, rounds: 3, queries_per_round: 300, test_samples: 300 },
  swarm: { particles: 100, iterations: 40, target_grasps: 60 },
};

export const readMug = (file: string): Buffer<ArrayBuffer> =>
  readFileSync(join(requirePath('GRASPDB_DATA'), 'mug', file));

async function call<Body>(url: string, init: RequestInit = {}): Promise<Body> {
  const response = await fetch(url, init);
  if (!response.ok) throw new Error(`${url}: ${response.status} ${await response.text()}`);
  return (await response.json()) as Body;
}

const postJson = <Body>(url: string, body: unknown): Promise<Body> =>
  call(url, {
    method: 'POST',
    headers: { 'Content-Type': 'application/json', Prefer: 'wait=600' },
    body: JSON.stringify(body),
  });

function makeForm(file: string, labels?: string): FormData {
  const form = new FormData();
  form.append('mesh', new Blob([readMug(file)]), file);
  if (labels !== undefined) {
    form.append('labels', new Blob([readMug(labels)], { type: 'application/json' }), labels);
  }
  return form;
}

export const upload = (url: string, file: string, query: string): Promise<Schemas['Object']> =>
  call(`${url}/v1/objects?${query}`, { method: 'POST', body: makeForm(file) });

export const queryGrasps = (url: string, query: string): Promise<Schemas['GraspPage']> =>
  call(`${url}/v1/grasps?${query}`);

/** A category of mugs, its example learned, grasps transferred to a novel mug. */
export async function seed(url: string): Promise<void> {
  const { name, title, parts, topology } = JSON.parse(readMug('category.json').toString()) as Record<string, unknown>;
  await postJson(`${url}/v1/categories`, { name, title, parts, topology });
  const example = await call<Schemas['Object']>(`${url}/v1/categories/mug/examples?learn=false&name=classic`, {
    method: 'POST',
    headers: { Prefer: 'wait=600' },
    body: makeForm('classic.obj', 'classic.labels.json'),
  });
  await postJson(`${url}/v1/objects/${example.id}/grasp-spaces`, { parts: ['body'], parameters: QUICK });
  await call(`${url}/v1/grasps?category=mug&sources=10`, {
    method: 'POST',
    headers: { Prefer: 'wait=600' },
    body: makeForm('latte.obj'),
  });
}
