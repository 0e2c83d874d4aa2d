import { useState } from 'preact/hooks';

import {
  getCategory, getTransfer, listGraspSpaces, listTransfers, MOST_ITEMS, queryGrasps,
} from '../../api/client';
import type { GraspSpace, TransferItem } from '../../api/types';
import { Link } from '../../app/navigation';
import { useResource } from '../../app/resource';
import { DirectionMap } from '../../charts/direction_map';
import { makeDomainFromZero } from '../../charts/scale';
import { LineChart } from '../../charts/line_chart';
import { ProblemNote } from '../../ui/problem_note';
import { partColour } from '../../ui/palette';
import { SelectField } from '../../ui/select_field';
import { OutcomeChart, QualityCharts } from './grasp_charts';

/** So many transfers, the newest, are counted. */
const MOST_TRANSFERS = 20;

async function loadCategory(name: string) {
  const [category, grasps, spaces, transfers] = await Promise.all([
    getCategory(name),
    queryGrasps({ category: name, stage: 'assembly', limit: MOST_ITEMS }),
    listGraspSpaces({ category: name }),
    listTransfers({ category: name, limit: MOST_TRANSFERS }),
  ]);
  const records = await Promise.all(transfers.items.map(({ id }) => getTransfer(id)));
  return {
    labels: category.parts.map(({ label }) => label),
    grasps: grasps.items,
    spaces: spaces.items,
    transfers: transfers.items,
    attempts: records.flatMap(({ attempts }) => attempts),
  };
}

function LearningCurves({ spaces, labels }: {
  readonly spaces: readonly GraspSpace[];
  readonly labels: readonly string[];
}) {
  const samples = spaces.flatMap(({ curve }) => curve.map((round) => round.samples));
  const lines = spaces.flatMap((space) => {
    const key = { name: space.part, colour: partColour(labels.indexOf(space.part)) };
    return [
      { ...key, points: space.curve.map((round) => [round.samples, round.balanced_accuracy] as const) },
      { ...key, dashed: true, points: space.curve.map((round) => [round.samples, round.boundary_accuracy] as const) },
    ];
  });
  return (
    <LineChart
      title="Learning curves"
      summary={`${spaces.length} grasp spaces, by rounds of active learning.`}
      x={{ label: 'configurations labelled', domain: makeDomainFromZero(samples) }}
      y={{ label: 'accuracy', domain: [0, 1] }}
      lines={lines}
      note="solid: balanced accuracy; dashed: near the boundary"
    />
  );
}

function Coverage({ spaces }: { readonly spaces: readonly GraspSpace[] }) {
  const [chosen, setChosen] = useState(spaces[0]?.id ?? '');
  const grasps = useResource(chosen, () =>
    queryGrasps({ grasp_space: chosen, stage: 'learned', limit: MOST_ITEMS }),
  );
  return (
    <div>
      <DirectionMap
        title="Directions from which a part is grasped"
        directions={(grasps.value?.items ?? []).map(({ pregrasp }) => pregrasp.approach)}
      />
      <SelectField
        label="Grasp space"
        value={chosen}
        options={spaces.map(({ id, part, hand }) => [id, `${part}, ${hand}`] as const)}
        onChange={setChosen}
      />
    </div>
  );
}

function TransferTable({ transfers }: { readonly transfers: readonly TransferItem[] }) {
  return (
    <section>
      <h2>Newest transfers</h2>
      <div class="scroll transfers">
        <table>
          <thead>
            <tr>
              <th>Time</th><th class="number">Tried</th>
              <th class="number">On the part</th><th class="number">On the whole</th>
            </tr>
          </thead>
          <tbody>
            {transfers.map(({ id, created_at, summary }) => (
              <tr key={id}>
                <td>
                  <Link to={{ view: 'insight', transfer: id }}>{new Date(created_at).toLocaleString()}</Link>
                </td>
                <td class="number">{summary.attempted}</td>
                <td class="number">{summary.transferred}</td>
                <td class="number">{summary.assembled ?? '–'}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}

/** What was learned and transferred in a category. */
export function CategoryInsight({ name }: { readonly name: string }) {
  const loaded = useResource(name, () => loadCategory(name));
  if (loaded.problem) return <ProblemNote problem={loaded.problem} retry={loaded.reload} />;
  if (!loaded.value) return <div class="skeleton charts-skeleton" aria-hidden="true" />;
  const { labels, grasps, spaces, transfers, attempts } = loaded.value;
  return (
    <div class="charts">
      <QualityCharts grasps={grasps} labels={labels} />
      <OutcomeChart attempts={attempts} labels={labels} />
      {spaces.length > 0 && <LearningCurves spaces={spaces} labels={labels} />}
      {spaces.length > 0 && <Coverage spaces={spaces} />}
      {transfers.length > 0 && <TransferTable transfers={transfers} />}
    </div>
  );
}
