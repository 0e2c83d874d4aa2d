import { readFileSync } from 'node:fs';

import { Matrix4 } from 'three';
import { describe, expect, it } from 'vitest';

import { withQuery } from '../src/api/client';
import { ProblemError, readProblem, toProblem } from '../src/api/problem';
import { remember } from '../src/api/remember';
import type { Attempt, Contact, Grasp } from '../src/api/types';
import { pairContacts } from '../src/robot/contact_pairs';
import { formatNumber, formatPoint, formatQuantity } from '../src/ui/format';
import { addGrasp } from '../src/views/upload/found_grasps';
import { countOutcomes } from '../src/views/insight/outcomes';

const EXAMPLE = new URL('../../../schema/examples/Grasp.json', import.meta.url);
const grasp = JSON.parse(readFileSync(EXAMPLE, 'utf8')) as Grasp;

describe('grasps that are found', () => {
  const withEpsilon = (id: string, epsilon: number): Grasp => ({
    ...grasp,
    id,
    quality: { ...grasp.quality, epsilon },
  });
  const [a, b, c] = [withEpsilon('a', 0.2), withEpsilon('b', 0.3), withEpsilon('c', 0.1)];

  it('stand best first', () => {
    expect([a, b, c].reduce<readonly Grasp[]>(addGrasp, []).map(({ id }) => id)).toEqual(['b', 'a', 'c']);
  });

  it('count once, however often they come', () => {
    expect([a, b, a].reduce<readonly Grasp[]>(addGrasp, [])).toHaveLength(2);
  });

  it('are as they came last', () => {
    const improved = withEpsilon('a', 0.4);
    expect([a, b, improved].reduce<readonly Grasp[]>(addGrasp, [])).toEqual([improved, b]);
  });
});

describe('contact pairs', () => {
  const touch = (link: string, x: number, mapped: number | null): Contact => ({
    link,
    p_O: [x, 0, 0],
    n_O: [0, 0, 1],
    mapped_p_O: mapped === null ? null : [mapped, 0, 0],
    seen: true,
  });
  const moved = new Matrix4().makeTranslation(1, 0, 0);

  it('join contacts of one link, the nearest under the map', () => {
    const source = [touch('a', 0, null), touch('a', 0.1, null), touch('b', 0, null)];
    const transferred = [touch('a', 5, 1.11), touch('a', 5, 1.01), touch('b', 5, 1.5)];
    const pairs = pairContacts(source, transferred, moved).map(({ p_E, p_N }) => [p_E.x, p_N.x]);
    expect(pairs.sort()).toEqual([[0, 1.01], [0, 1.5], [0.1, 1.11]].sort());
  });

  it('are none for contacts that were not mapped, and one for a point that serves two', () => {
    const source = [touch('a', 0, null), touch('a', 0.1, null)];
    const transferred = [touch('a', 5, null), touch('a', 5, 1), touch('a', 6, 1)];
    expect(pairContacts(source, transferred, moved)).toHaveLength(1);
  });
});

describe('outcomes', () => {
  const attempt = (part: string, transfer: Attempt['transfer'], assembly: Attempt['assembly']) =>
    ({ part, transfer, assembly }) as Attempt;

  it('are counted by part, success first, then the commonest', () => {
    const { outcomes, counts } = countOutcomes([
      attempt('body', 'too_far', null),
      attempt('body', 'succeeded', 'palm_collision'),
      attempt('handle', 'succeeded', 'palm_collision'),
      attempt('handle', 'succeeded', 'succeeded'),
    ]);
    expect(outcomes).toEqual(['succeeded', 'whole: palm collision', 'part: too far']);
    expect(counts.get('body')).toEqual([0, 1, 1]);
    expect(counts.get('handle')).toEqual([1, 1, 0]);
  });
});

describe('problems', () => {
  it('keep the hint of the server', async () => {
    const body = { type: 't', title: 't', status: 422, detail: 'Too big.', hint: 'Say mm.', code: 'c', request_id: 'r' };
    const problem = await readProblem(new Response(JSON.stringify(body), { status: 422 }));
    expect([problem.message, problem.hint, problem.status]).toEqual(['Too big.', 'Say mm.', 422]);
  });

  it('are readable when the answer is none of the server', async () => {
    const problem = await readProblem(new Response('<html>', { status: 502, statusText: 'Bad Gateway' }));
    expect(problem.message).toBe('The server answered 502 Bad Gateway.');
  });

  it('say so when the server is away', () => {
    expect(toProblem(new TypeError('Failed to fetch'))).toBeInstanceOf(ProblemError);
    expect(toProblem(new TypeError('Failed to fetch')).hint).toContain('graspdb serve');
  });
});

describe('a query', () => {
  it('leaves out what is not given and keeps zero', () => {
    expect(withQuery('/v1/x', { a: undefined, b: '', c: 0, d: 'm m' })).toBe('/v1/x?c=0&d=m+m');
  });
});

describe('what is remembered', () => {
  it('is loaded once, unless it failed', async () => {
    let calls = 0;
    const load = remember((name: string) => {
      ++calls;
      return calls === 1 ? Promise.reject(new Error(name)) : Promise.resolve(name);
    });
    await expect(load('a')).rejects.toThrow('a');
    expect(await load('a')).toBe('a');
    expect(await load('a')).toBe('a');
    expect(calls).toBe(2);
  });
});

describe('numbers', () => {
  it('have no minus before a zero and a dash for nothing', () => {
    expect(formatNumber(-0.00001, 4)).toBe('0.0000');
    expect(formatNumber(null)).toBe('–');
    expect(formatPoint([-0.1, -1e-9, 2])).toBe('-0.1000, 0.0000, 2.0000');
  });

  it('are written with a power of ten when that is shorter', () => {
    expect(formatQuantity(6.58985e-5, 'm³')).toBe('6.59 × 10⁻⁵ m³');
    expect(formatQuantity(0.0386, 'm²')).toBe('0.0386 m²');
    expect(formatQuantity(0, 'm')).toBe('0 m');
  });
});
