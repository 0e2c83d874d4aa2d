import type { ComponentChildren } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';

import { makeLinearScale, makeTicks, type Scale } from './scale';

/** One axis of a chart. */
export interface Axis {
  readonly label: string;
  readonly domain: readonly [number, number];
  /** Whether it counts things, of which there are no halves. */
  readonly counts?: boolean;
  /** Default: round numbers. */
  readonly ticks?: readonly (readonly [value: number, text: string])[];
}

interface ChartFrameProps {
  readonly title: string;
  /** What it shows, for those who cannot see it. */
  readonly summary: string;
  readonly x: Axis;
  readonly y: Axis;
  /** Equal lengths on both axes, as a scatter with a diagonal needs. */
  readonly square?: boolean;
  /** Room for the ticks of y, px. */
  readonly left?: number;
  readonly legend?: ComponentChildren;
  readonly children: (x: Scale, y: Scale) => ComponentChildren;
}

const HEIGHT = 300;
const MARGIN = { top: 12, right: 16, bottom: 44, left: 52 };
const TICK_GAP = 80; // px

function tickPairs(
  { ticks, domain, counts = false }: Axis,
  length: number,
): readonly (readonly [number, string])[] {
  if (ticks) return ticks;
  return makeTicks(domain, Math.max(2, Math.floor(length / TICK_GAP)))
    .filter((value) => !counts || Number.isInteger(value))
    .map((value) => [value, String(value)] as const);
}

function useWidth() {
  const element = useRef<HTMLDivElement>(null);
  const [width, setWidth] = useState(0);
  useEffect(() => {
    if (!element.current) return;
    const observer = new ResizeObserver(([entry]) => {
      if (entry) setWidth(Math.floor(entry.contentRect.width));
    });
    observer.observe(element.current);
    return () => { observer.disconnect(); };
  }, []);
  return { element, width };
}

/** Title, axes with ticks, labels and grid; the children draw the data. Drawn in
 * pixels of its place, so that letters have the same size everywhere. */
export function ChartFrame({
  title, summary, x, y, square = false, left = MARGIN.left, legend, children,
}: ChartFrameProps) {
  const { element, width } = useWidth();
  const plotHeight = HEIGHT - MARGIN.top - MARGIN.bottom;
  const room = Math.max(width - left - MARGIN.right, 0);
  const plotWidth = square ? Math.min(room, plotHeight) : room;
  const bottom = MARGIN.top + plotHeight;
  const start = left + (room - plotWidth) / 2;
  const xScale = makeLinearScale(x.domain, [start, start + plotWidth]);
  const yScale = makeLinearScale(y.domain, [bottom, MARGIN.top]);
  return (
    <figure class="chart">
      <figcaption>
        <h2>{title}</h2>
        {legend}
      </figcaption>
      <div class="chart-place" ref={element}>
        {width > 0 && (
          <svg width={width} height={HEIGHT} role="img" aria-label={`${title}. ${summary}`}>
            {tickPairs(y, plotHeight).map(([value, text]) => (
              <g key={value} class="tick">
                <line x1={start} x2={start + plotWidth} y1={yScale.toPixel(value)} y2={yScale.toPixel(value)} />
                <text x={start - 8} y={yScale.toPixel(value)} dy="0.32em" text-anchor="end">{text}</text>
              </g>
            ))}
            {tickPairs(x, plotWidth).map(([value, text]) => (
              <g key={value} class="tick">
                <line x1={xScale.toPixel(value)} x2={xScale.toPixel(value)} y1={MARGIN.top} y2={bottom} />
                <text x={xScale.toPixel(value)} y={bottom + 16} text-anchor="middle">{text}</text>
              </g>
            ))}
            {children(xScale, yScale)}
            <path class="axis" d={`M${start} ${MARGIN.top}V${bottom}H${start + plotWidth}`} />
            <text class="axis-label" x={start + plotWidth / 2} y={HEIGHT - 8} text-anchor="middle">{x.label}</text>
            <text
              class="axis-label"
              transform={`translate(${start - left + 12} ${MARGIN.top + plotHeight / 2}) rotate(-90)`}
              text-anchor="middle"
            >
              {y.label}
            </text>
          </svg>
        )}
      </div>
    </figure>
  );
}
