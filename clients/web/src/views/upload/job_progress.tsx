import { useEffect, useReducer, useState } from 'preact/hooks';

import { cancelJob, MOST_ITEMS, queryGrasps } from '../../api/client';
import { followJob, isFinished } from '../../api/job_events';
import { ProblemError, toProblem } from '../../api/problem';
import type { Grasp, Job } from '../../api/types';
import { Link } from '../../app/navigation';
import { useResource } from '../../app/resource';
import type { GraspExtra } from '../../app/routes';
import { ProblemNote } from '../../ui/problem_note';
import { GraspBench } from '../grasps/grasp_bench';
import { GraspList } from '../grasps/grasp_list';
import { addGrasp } from './found_grasps';
import { StageLog, useStageLog } from './stage_log';

/** What a job that failed says of it. */
function findProblem({ error }: Job): ProblemError | null {
  return error && new ProblemError({ status: 0, ...error });
}

/** A transfer while it runs: its stages, and its grasps as they are found. */
export function JobProgress({ id }: { readonly id: string }) {
  const [job, setJob] = useState<Job | null>(null);
  const [lost, setLost] = useState<ProblemError | null>(null);
  const [found, add] = useReducer(addGrasp, []);
  const [chosen, setChosen] = useState<string | null>(null);
  const [show, setShow] = useState<GraspExtra | null>(null);
  const stages = useStageLog(job);
  useEffect(() => followJob(id, { onJob: setJob, onGrasp: add, onProblem: setLost }), [id]);

  // When it is done the server knows the order of merit, and what was rejected.
  const transfer = job?.result?.transfer ?? null;
  const final = useResource(transfer, () =>
    queryGrasps({ transfer: transfer ?? '', stage: 'assembly', sort: 'merit', limit: MOST_ITEMS }),
  );
  const grasps: readonly Grasp[] = final.value?.items ?? found;
  const grasp = grasps.find((each) => each.id === chosen) ?? grasps[0] ?? null;
  const problem = lost ?? final.problem ?? (job && findProblem(job));
  return (
    <div class="workbench three">
      <div class="workbench-list">
        <h1>Transfer</h1>
        <StageLog job={job} stages={stages} numGrasps={grasps.length} />
        {problem && <ProblemNote problem={problem} />}
        <p class="actions">
          {job && !isFinished(job) && (
            <button type="button" onClick={() => { cancelJob(id).then(setJob, (error: unknown) => { setLost(toProblem(error)); }); }}>
              Cancel
            </button>
          )}
          {transfer !== null && (
            <>
              <Link class="button" to={{ view: 'grasps', filters: { transfer, stage: 'assembly', sort: 'merit' } }}>
                Keep a link to these
              </Link>
              <Link class="button" to={{ view: 'insight', transfer }}>Why others were rejected</Link>
            </>
          )}
        </p>
        {(grasps.length > 0 || transfer !== null) && (
          <GraspList grasps={grasps} loading={final.loading && grasps.length === 0} loadMore={null}
            chosen={grasp?.id ?? null} onChoose={setChosen} />
        )}
      </div>
      <GraspBench
        grasp={grasp}
        recorded={transfer !== null}
        others={grasps}
        show={show}
        onShow={setShow}
        onChoose={setChosen}
      />
    </div>
  );
}
