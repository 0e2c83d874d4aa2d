/** From data to pixels along one axis. */
export interface Scale {
  readonly domain: readonly [number, number];
  readonly toPixel: (value: number) => number;
}

export function makeLinearScale(
  domain: readonly [number, number],
  range: readonly [number, number],
): Scale {
  const [low, high] = domain;
  const [start, end] = range;
  const span = high - low || 1;
  return { domain, toPixel: (value) => start + ((value - low) / span) * (end - start) };
}

/** The largest of 1, 2, 5 × 10ⁿ that gives at least `count` steps. */
export function chooseStep(span: number, count: number): number {
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const share = rough / power;
  // Rounding may have put a power of ten just below itself.
  const tolerance = 1 + 1e-9;
  return power * (share * tolerance >= 5 ? 5 : share * tolerance >= 2 ? 2 : 1);
}

/** Round numbers within the domain, about `count` of them. */
export function makeTicks([low, high]: readonly [number, number], count = 5): number[] {
  if (!(high > low)) return [low];
  const step = chooseStep(high - low, count);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  // Multiples, not sums, so that 0.3 does not become 0.30000000000000004.
  return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** [0, a round number that is not less than any value]. */
export function makeDomainFromZero(values: readonly number[], count = 5): [number, number] {
  const most = Math.max(0, ...values);
  if (most === 0) return [0, 1];
  const step = chooseStep(most, count);
  return [0, Number((Math.ceil(most / step - 1e-9) * step).toPrecision(12))];
}

/** How many values fall into each of `numBins` equal bins of the domain, whose
 * upper end belongs to the last. */
export function countInBins(
  values: readonly number[],
  [low, high]: readonly [number, number],
  numBins: number,
): number[] {
  const counts = new Array<number>(numBins).fill(0);
  for (const value of values) {
    const bin = Math.min(Math.floor(((value - low) / (high - low)) * numBins), numBins - 1);
    if (bin >= 0 && value <= high) counts[bin] = (counts[bin] ?? 0) + 1;
  }
  return counts;
}
