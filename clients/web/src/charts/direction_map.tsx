import { formatShare } from '../ui/format';
import { ChartFrame } from './chart_frame';
import { countDirections, NUM_AZIMUTHS, NUM_HEIGHTS } from './directions';

interface DirectionMapProps {
  readonly title: string;
  readonly directions: readonly (readonly [number, number, number])[];
}

const AZIMUTH_TICKS = [
  [-Math.PI, '−π'], [-Math.PI / 2, '−π/2'], [0, '0'], [Math.PI / 2, 'π/2'], [Math.PI, 'π'],
] as const;
/** Elevations in radians, at the height where they lie. */
const ELEVATION_TICKS = [
  [-1, '−π/2'], [-Math.SQRT1_2, '−π/4'], [0, '0'], [Math.SQRT1_2, 'π/4'], [1, 'π/2'],
] as const;

/** Where directions point, on a map of the sphere whose cells have equal areas. */
export function DirectionMap({ title, directions }: DirectionMapProps) {
  const cells = countDirections(directions);
  const most = Math.max(1, ...cells.map(({ count }) => count));
  const reached = cells.filter(({ count }) => count > 0).length / cells.length;
  return (
    <ChartFrame
      title={title}
      summary={`${directions.length} grasps reach ${formatShare(reached)} of all directions.`}
      x={{ label: 'azimuth of the approach in frame O (rad)', domain: [-Math.PI, Math.PI], ticks: AZIMUTH_TICKS }}
      y={{ label: 'elevation (rad), equal areas', domain: [-1, 1], ticks: ELEVATION_TICKS }}
      legend={
        <p class="chart-note">
          {formatShare(reached)} of all directions reached; darkest: {most} {most === 1 ? 'grasp' : 'grasps'}
        </p>
      }
    >
      {(x, y) =>
        cells.map(({ azimuthBin, heightBin, count }) => {
          const left = x.toPixel(((2 * azimuthBin) / NUM_AZIMUTHS - 1) * Math.PI);
          const right = x.toPixel(((2 * (azimuthBin + 1)) / NUM_AZIMUTHS - 1) * Math.PI);
          const bottom = y.toPixel((2 * heightBin) / NUM_HEIGHTS - 1);
          const top = y.toPixel((2 * (heightBin + 1)) / NUM_HEIGHTS - 1);
          return (
            <rect
              key={`${azimuthBin} ${heightBin}`}
              class="direction-cell"
              x={left + 0.5}
              y={top + 0.5}
              width={right - left - 1}
              height={bottom - top - 1}
              fill-opacity={count === 0 ? 0.06 : 0.2 + (0.8 * count) / most}
            >
              <title>{count}</title>
            </rect>
          );
        })
      }
    </ChartFrame>
  );
}
