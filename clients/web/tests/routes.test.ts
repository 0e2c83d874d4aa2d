import { describe, expect, it } from 'vitest';

import { formatRoute, parseRoute, type Route } from '../src/app/routes';

const ID = '01a2037c-478c-7000-a389-2d681db16009';
const HASH = 'b42ce2e8711e9eeb6d87d3abbaf4e01a';

describe('a link', () => {
  const routes: readonly Route[] = [
    { view: 'browse' },
    { view: 'browse', category: 'mug' },
    { view: 'object', object: ID },
    { view: 'grasps', filters: {} },
    {
      view: 'grasps',
      filters: {
        category: 'mug', object: ID, grasp_space: HASH, transfer: HASH, part: 'handle', task: 'use',
        hand: 'barrett-bh8-280', min_epsilon: 0.05, verified: 'physical', stage: 'assembly', sort: 'merit',
      },
      grasp: HASH,
      show: 'source',
    },
    { view: 'upload' },
    { view: 'upload', object: ID, job: ID },
    { view: 'insight', category: 'mug' },
    { view: 'insight', transfer: HASH },
  ];
  it.each(routes)('brings back the state that it was made of: %o', (route) => {
    const url = new URL(formatRoute(route), 'http://localhost');
    expect(url.pathname).toBe('/');
    expect(parseRoute(url.search)).toEqual(route);
  });

  it('to the start page is /', () => {
    expect(formatRoute({ view: 'browse' })).toBe('/');
  });

  it('drops what the contract does not know', () => {
    expect(parseRoute('?view=grasps&stage=nonsense&sort=&min_epsilon=x&verified=1&show=2')).toEqual({
      view: 'grasps',
      filters: {},
    });
  });

  it('that is not understood leads to the start page', () => {
    expect(parseRoute('?view=nonsense')).toEqual({ view: 'browse' });
    expect(parseRoute('?view=object')).toEqual({ view: 'browse' });
  });
});
