import { getCategory, getTransfer, MOST_ITEMS, queryGrasps } from '../../api/client';
import type { Transfer } from '../../api/types';
import { Link } from '../../app/navigation';
import { useResource } from '../../app/resource';
import { Facts } from '../../ui/facts';
import { formatNumber, formatWords } from '../../ui/format';
import { ProblemNote } from '../../ui/problem_note';
import { OutcomeChart, QualityCharts } from './grasp_charts';

async function loadTransfer(id: string) {
  const [transfer, grasps] = await Promise.all([
    getTransfer(id),
    queryGrasps({ transfer: id, stage: 'assembly', limit: MOST_ITEMS }),
  ]);
  const category = await getCategory(transfer.category);
  return { transfer, grasps: grasps.items, labels: category.parts.map(({ label }) => label) };
}

function TransferFacts({ transfer }: { readonly transfer: Transfer }) {
  const { summary } = transfer;
  return (
    <div class="fact-columns">
      <Facts
        facts={[
          ['Tried', summary.attempted],
          ['On the part', summary.transferred],
          ['On the whole object', summary.assembled ?? 'not asked for'],
          ['Open-close alone', summary.baseline_open_close],
          ['Similarity', formatNumber(transfer.similarity, 2)],
        ]}
      />
      <Facts
        facts={Object.entries(transfer.seconds).map(([stage, seconds]) => [
          formatWords(stage),
          `${seconds.toFixed(2)} s`,
        ])}
      />
    </div>
  );
}

/** One transfer: what came of each source grasp, and what took how long. */
export function TransferInsight({ id }: { readonly id: string }) {
  const loaded = useResource(id, () => loadTransfer(id));
  return (
    <div class="page">
      <h1>Transfer</h1>
      {loaded.problem && <ProblemNote problem={loaded.problem} retry={loaded.reload} />}
      {!loaded.value && !loaded.problem && <div class="skeleton charts-skeleton" aria-hidden="true" />}
      {loaded.value && (
        <>
          <p class="subtitle">
            to <Link to={{ view: 'object', object: loaded.value.transfer.object }}>an object</Link> of{' '}
            <Link to={{ view: 'insight', category: loaded.value.transfer.category }}>
              {loaded.value.transfer.category}
            </Link>{' '}
            ·{' '}
            <Link to={{ view: 'grasps', filters: { transfer: id, stage: 'assembly', sort: 'merit' } }}>
              its grasps
            </Link>
          </p>
          <TransferFacts transfer={loaded.value.transfer} />
          {loaded.value.transfer.warnings.map((warning) => (
            <p class="warning" key={warning}>{warning}</p>
          ))}
          <div class="charts">
            <OutcomeChart attempts={loaded.value.transfer.attempts} labels={loaded.value.labels} />
            <QualityCharts grasps={loaded.value.grasps} labels={loaded.value.labels} />
          </div>
        </>
      )}
    </div>
  );
}
