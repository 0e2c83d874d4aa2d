/** Unit vectors on a rectangle, equal areas of the sphere as equal areas of it
 * (Lambert's cylindrical projection): azimuth about z from x, and z itself. */
export const NUM_AZIMUTHS = 16;
export const NUM_HEIGHTS = 8;

export interface DirectionCell {
  readonly azimuthBin: number;
  readonly heightBin: number;
  readonly count: number;
}

const bin = (share: number, numBins: number): number =>
  Math.min(Math.max(Math.floor(share * numBins), 0), numBins - 1);

/** How many directions fall into each cell; all cells, row by row from below. */
export function countDirections(directions: readonly (readonly [number, number, number])[]): DirectionCell[] {
  const counts = new Array<number>(NUM_AZIMUTHS * NUM_HEIGHTS).fill(0);
  for (const [x, y, z] of directions) {
    const azimuth = Math.atan2(y, x);
    const cell =
      bin((z + 1) / 2, NUM_HEIGHTS) * NUM_AZIMUTHS + bin((azimuth + Math.PI) / (2 * Math.PI), NUM_AZIMUTHS);
    counts[cell] = (counts[cell] ?? 0) + 1;
  }
  return counts.map((count, cell) => ({
    azimuthBin: cell % NUM_AZIMUTHS,
    heightBin: Math.floor(cell / NUM_AZIMUTHS),
    count,
  }));
}
