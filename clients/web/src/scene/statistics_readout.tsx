import { useEffect, useState } from 'preact/hooks';

import { formatCount } from '../ui/format';
import type { FrameStatistics, Stage } from './stage';

const wanted = new URLSearchParams(window.location.search).has('stats');

/** With ?stats=1: what a frame takes. The time is that of the page's thread. */
export function StatisticsReadout({ stage }: { readonly stage: Stage }) {
  const [statistics, setStatistics] = useState<FrameStatistics | null>(null);
  useEffect(() => (wanted ? stage.onFrame(setStatistics) : undefined), [stage]);
  if (!statistics) return null;
  const { drawCalls, triangles, milliseconds } = statistics;
  return (
    <p class="viewport-statistics">
      {formatCount(drawCalls)} draw calls · {formatCount(triangles)} triangles ·{' '}
      {milliseconds.toFixed(1)} ms
      <button
        type="button"
        class="quiet"
        onClick={() => {
          setStatistics(stage.drawAndFinish());
        }}
      >
        Measure
      </button>
    </p>
  );
}
