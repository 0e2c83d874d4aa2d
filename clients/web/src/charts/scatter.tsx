import { ChartFrame } from './chart_frame';
import { makeDomainFromZero } from './scale';
import { type SeriesKey, SeriesLegend } from './series_legend';

interface ScatterPoint {
  readonly x: number;
  readonly y: number;
}

interface ScatterProps {
  readonly title: string;
  readonly xLabel: string;
  readonly yLabel: string;
  readonly series: readonly (SeriesKey & { readonly points: readonly ScatterPoint[] })[];
}

/** Two measures of the same kind, with the diagonal on which they are equal. */
export function Scatter({ title, xLabel, yLabel, series }: ScatterProps) {
  const points = series.flatMap((each) => each.points);
  const domain = makeDomainFromZero(points.flatMap(({ x, y }) => [x, y]));
  const above = points.filter(({ x, y }) => y > x).length;
  return (
    <ChartFrame
      title={title}
      summary={`${above} of ${points.length} lie above the diagonal.`}
      x={{ label: xLabel, domain }}
      y={{ label: yLabel, domain }}
      square
      legend={
        <>
          <SeriesLegend series={series} />
          <p class="chart-note">{above} of {points.length} above the diagonal</p>
        </>
      }
    >
      {(x, y) => (
        <>
          <line
            class="diagonal"
            x1={x.toPixel(0)}
            y1={y.toPixel(0)}
            x2={x.toPixel(domain[1])}
            y2={y.toPixel(domain[1])}
          />
          {series.flatMap(({ name, colour, points: own }) =>
            own.map((point, index) => (
              <circle
                key={`${name} ${index}`}
                cx={x.toPixel(point.x)}
                cy={y.toPixel(point.y)}
                r="3"
                fill={colour}
                fill-opacity="0.85"
              />
            )),
          )}
        </>
      )}
    </ChartFrame>
  );
}
