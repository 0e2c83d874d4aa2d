import { ChartFrame } from './chart_frame';
import { makeDomainFromZero } from './scale';
import { type SeriesKey, SeriesLegend } from './series_legend';

interface BarsProps {
  readonly title: string;
  readonly xLabel: string;
  readonly rows: readonly string[];
  /** One count per row. */
  readonly series: readonly (SeriesKey & { readonly counts: readonly number[] })[];
}

const NAME_ROOM = 172; // px, for "whole: no correspondence"
const BAR_SHARE = 0.62;
const THICKEST = 30; // px
/** Beyond the longest bar stands its count. */
const COUNT_ROOM = 1.08;

/** Counts by name, lying bars, the series after each other. */
export function Bars({ title, xLabel, rows, series }: BarsProps) {
  const totals = rows.map((_, row) => series.reduce((sum, { counts }) => sum + (counts[row] ?? 0), 0));
  const place = (row: number): number => rows.length - row - 0.5;
  return (
    <ChartFrame
      title={title}
      summary={rows.map((name, row) => `${name}: ${totals[row] ?? 0}`).join(', ')}
      x={{ label: xLabel, domain: makeDomainFromZero(totals.map((total) => COUNT_ROOM * total)), counts: true }}
      y={{
        label: '',
        domain: [0, Math.max(rows.length, 1)],
        ticks: rows.map((name, row) => [place(row), name] as const),
      }}
      left={NAME_ROOM}
      legend={<SeriesLegend series={series} />}
    >
      {(x, y) =>
        rows.map((name, row) => {
          const middle = y.toPixel(place(row));
          const room = y.toPixel(place(row) - BAR_SHARE / 2) - y.toPixel(place(row) + BAR_SHARE / 2);
          const height = Math.min(room, THICKEST);
          const top = middle - height / 2;
          return (
            <g key={name}>
              {series.map(({ name: of, colour, counts }, s) => {
                const before = series.slice(0, s).reduce((sum, other) => sum + (other.counts[row] ?? 0), 0);
                const start = x.toPixel(before);
                return (
                  <rect
                    key={of}
                    x={start}
                    width={x.toPixel(before + (counts[row] ?? 0)) - start}
                    y={top}
                    height={height}
                    fill={colour}
                  />
                );
              })}
              <text class="bar-count" x={x.toPixel(totals[row] ?? 0) + 5} y={middle} dy="0.32em">
                {totals[row]}
              </text>
            </g>
          );
        })
      }
    </ChartFrame>
  );
}
