import { useEffect, useState } from 'preact/hooks';

import { isFinished } from '../../api/job_events';
import type { Job } from '../../api/types';

/** The stages of a job so far, in their order. */
export function useStageLog(job: Job | null): readonly string[] {
  const [stages, setStages] = useState<readonly string[]>([]);
  const stage = job && !isFinished(job) ? job.stage : null;
  useEffect(() => {
    if (stage === null || stage === '') return;
    setStages((before) => (before.includes(stage) ? before : [...before, stage]));
  }, [stage]);
  return stages;
}

interface StageLogProps {
  readonly job: Job | null;
  readonly stages: readonly string[];
  readonly numGrasps: number;
}

function describeState(job: Job | null, numGrasps: number): string {
  if (!job) return 'Asking the server …';
  const grasps = `${numGrasps} ${numGrasps === 1 ? 'grasp' : 'grasps'}`;
  if (isFinished(job)) return `${job.state[0]?.toUpperCase() ?? ''}${job.state.slice(1)}: ${grasps}`;
  if (job.state === 'queued') return 'Waiting for its turn';
  const eta = job.eta_s === null ? '' : `, about ${Math.ceil(job.eta_s)} s to go`;
  return `${grasps} so far${eta}`;
}

/** What a job has done, does, and how far it is. */
export function StageLog({ job, stages, numGrasps }: StageLogProps) {
  const running = job !== null && !isFinished(job);
  return (
    <section class="stage-log">
      <progress max={1} value={job?.progress ?? 0} aria-label="Progress of the transfer" />
      <p role="status">{describeState(job, numGrasps)}</p>
      <ol>
        {stages.map((stage) => (
          <li key={stage} class={running && stage === job.stage ? 'is-current' : 'is-done'}>
            {stage}
          </li>
        ))}
      </ol>
    </section>
  );
}
