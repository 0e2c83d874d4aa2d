import type { Attempt, Grasp } from '../../api/types';
import { Bars } from '../../charts/bars';
import { Histogram } from '../../charts/histogram';
import { Scatter } from '../../charts/scatter';
import { partColour } from '../../ui/palette';
import { countOutcomes } from './outcomes';

interface QualityChartsProps {
  readonly grasps: readonly Grasp[];
  /** The parts in the category's order. */
  readonly labels: readonly string[];
}

/** How good grasps are, and whether better than those that they come from. */
export function QualityCharts({ grasps, labels }: QualityChartsProps) {
  const byPart = labels.map((name, index) => ({
    name,
    colour: partColour(index),
    grasps: grasps.filter(({ part }) => part === name),
  }));
  return (
    <>
      <Histogram
        title="Quality of the grasps"
        xLabel="ε on the whole object"
        series={byPart.map(({ grasps: own, ...key }) => ({
          ...key,
          values: own.map(({ quality }) => quality.epsilon),
        }))}
      />
      <Scatter
        title="Novel object against example"
        xLabel="ε of the source grasp on the example"
        yLabel="ε on the novel object"
        series={byPart.map(({ grasps: own, ...key }) => ({
          ...key,
          points: own.map(({ quality }) => ({ x: quality.example_epsilon, y: quality.epsilon })),
        }))}
      />
    </>
  );
}

/** How the source grasps that were tried ended. */
export function OutcomeChart({ attempts, labels }: {
  readonly attempts: readonly Attempt[];
  readonly labels: readonly string[];
}) {
  const { outcomes, counts } = countOutcomes(attempts);
  return (
    <Bars
      title="Why grasps were rejected"
      xLabel={`source grasps tried, ${attempts.length} in all`}
      rows={outcomes}
      series={labels.map((name, index) => ({
        name,
        colour: partColour(index),
        counts: counts.get(name) ?? [],
      }))}
    />
  );
}
