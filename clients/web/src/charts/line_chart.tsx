import { type Axis, ChartFrame } from './chart_frame';
import { type SeriesKey, SeriesLegend } from './series_legend';

export interface Line extends SeriesKey {
  readonly points: readonly (readonly [x: number, y: number])[];
  readonly dashed?: boolean;
}

interface LineChartProps {
  readonly title: string;
  readonly summary: string;
  readonly x: Axis;
  readonly y: Axis;
  readonly lines: readonly Line[];
  readonly note?: string;
}

export function LineChart({ title, summary, x: xAxis, y: yAxis, lines, note }: LineChartProps) {
  const keys = [...new Map(lines.map(({ name, colour }) => [name, { name, colour }])).values()];
  return (
    <ChartFrame
      title={title}
      summary={summary}
      x={xAxis}
      y={yAxis}
      legend={
        <>
          <SeriesLegend series={keys} />
          {note !== undefined && <p class="chart-note">{note}</p>}
        </>
      }
    >
      {(x, y) =>
        lines.map(({ colour, points, dashed = false }, index) => (
          <g key={index} stroke={colour} fill={colour}>
            <polyline
              class={dashed ? 'line dashed' : 'line'}
              points={points.map(([a, b]) => `${x.toPixel(a)},${y.toPixel(b)}`).join(' ')}
            />
            {points.map(([a, b]) => (
              <circle key={a} cx={x.toPixel(a)} cy={y.toPixel(b)} r="2.5" stroke="none" />
            ))}
          </g>
        ))
      }
    </ChartFrame>
  );
}
