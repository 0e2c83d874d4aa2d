import { ChartFrame } from './chart_frame';
import { countInBins, makeDomainFromZero } from './scale';
import { type SeriesKey, SeriesLegend } from './series_legend';

interface HistogramProps {
  readonly title: string;
  readonly xLabel: string;
  readonly series: readonly (SeriesKey & { readonly values: readonly number[] })[];
}

const NUM_BINS = 20;

/** How often values occur, the series on top of each other. */
export function Histogram({ title, xLabel, series }: HistogramProps) {
  const all = series.flatMap(({ values }) => values);
  const domain = makeDomainFromZero(all);
  const stacks = series.map(({ values }) => countInBins(values, domain, NUM_BINS));
  const totals = countInBins(all, domain, NUM_BINS);
  const width = (domain[1] - domain[0]) / NUM_BINS;
  return (
    <ChartFrame
      title={title}
      summary={`${all.length} grasps; ${describeMedian(all)}`}
      x={{ label: xLabel, domain }}
      y={{ label: 'grasps', domain: makeDomainFromZero(totals), counts: true }}
      legend={<SeriesLegend series={series} />}
    >
      {(x, y) =>
        stacks.flatMap((counts, s) =>
          counts.map((count, bin) => {
            const below = stacks.slice(0, s).reduce((sum, other) => sum + (other[bin] ?? 0), 0);
            const left = x.toPixel(domain[0] + bin * width);
            const right = x.toPixel(domain[0] + (bin + 1) * width);
            const top = y.toPixel(below + count);
            return (
              <rect
                key={`${s} ${bin}`}
                x={left + 0.5}
                width={Math.max(right - left - 1, 0.5)}
                y={top}
                height={y.toPixel(below) - top}
                fill={series[s]?.colour}
              />
            );
          }),
        )
      }
    </ChartFrame>
  );
}

function describeMedian(values: readonly number[]): string {
  const median = values.slice().sort((a, b) => a - b)[Math.floor(values.length / 2)];
  return median === undefined ? 'none yet' : `median ${median.toFixed(3)}`;
}
