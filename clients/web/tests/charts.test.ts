import { describe, expect, it } from 'vitest';

import { countDirections, NUM_AZIMUTHS, NUM_HEIGHTS } from '../src/charts/directions';
import { chooseStep, countInBins, makeDomainFromZero, makeLinearScale, makeTicks } from '../src/charts/scale';

describe('a scale', () => {
  it('maps the ends of the data to the ends of the axis, also upside down', () => {
    const { toPixel } = makeLinearScale([0, 2], [100, 0]);
    expect([0, 1, 2].map(toPixel)).toEqual([100, 50, 0]);
  });
});

describe('ticks', () => {
  it.each([
    [[0, 1], [0, 0.2, 0.4, 0.6, 0.8, 1]],
    [[0, 0.3], [0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]],
    [[-1, 1], [-1, -0.8, -0.6, -0.4, -0.2, 0, 0.2, 0.4, 0.6, 0.8, 1]],
    [[0, 4000], [0, 500, 1000, 1500, 2000, 2500, 3000, 3500, 4000]],
  ] as const)('of %o are round and within', (domain, expected) => {
    expect(makeTicks(domain).map((tick) => tick + 0)).toEqual(expected);
  });

  it('of nothing are its only value', () => {
    expect(makeTicks([3, 3])).toEqual([3]);
  });

  it('have steps of 1, 2 or 5', () => {
    expect([0.1, 1, 2.4, 3, 7].map((span) => chooseStep(span, 1))).toEqual([0.1, 1, 2, 2, 5]);
  });
});

describe('a domain from zero', () => {
  it('ends at a round number that holds all values', () => {
    expect(makeDomainFromZero([0.166])).toEqual([0, 0.18]);
    expect(makeDomainFromZero([22])).toEqual([0, 22]);
  });

  it('of no values is not empty', () => {
    expect(makeDomainFromZero([])).toEqual([0, 1]);
  });
});

describe('bins', () => {
  it('take their lower end, the last its upper, too', () => {
    expect(countInBins([0, 0.5, 0.99, 1], [0, 1], 2)).toEqual([1, 3]);
  });

  it('ignore what lies outside', () => {
    expect(countInBins([-1, 2], [0, 1], 2)).toEqual([0, 0]);
  });
});

describe('directions', () => {
  it('fall into the cell of their azimuth and height, poles and seam included', () => {
    const cells = countDirections([[0, 0, 1], [0, 0, -1], [-1, 0, 0], [0.6, 0.8, 0]]);
    expect(cells).toHaveLength(NUM_AZIMUTHS * NUM_HEIGHTS);
    expect(cells.reduce((sum, { count }) => sum + count, 0)).toBe(4);
    const filled = cells.filter(({ count }) => count > 0);
    expect(filled.map(({ heightBin }) => heightBin)).toEqual([0, 4, 4, 7]);
    expect(filled.map(({ azimuthBin }) => azimuthBin)).toEqual([8, 10, 15, 8]);
  });
});
