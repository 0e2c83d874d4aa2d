import { getJob } from './client';
import { type ProblemError, toProblem } from './problem';
import type { Grasp, Job } from './types';

export interface JobListener {
  readonly onJob: (job: Job) => void;
  /** As soon as it is found; after a reconnection perhaps once more. */
  readonly onGrasp: (grasp: Grasp) => void;
  readonly onProblem: (problem: ProblemError) => void;
}

export const isFinished = ({ state }: Job): boolean => state !== 'queued' && state !== 'running';

/** Follows a job's event stream until the job has finished; gives back how to
 * stop before. A broken connection is taken up again by the browser itself. */
export function followJob(id: string, { onJob, onGrasp, onProblem }: JobListener): () => void {
  const events = new EventSource(`/v1/jobs/${id}/events`);
  events.addEventListener('job', ({ data }: MessageEvent<string>) => {
    const job = JSON.parse(data) as Job;
    if (isFinished(job)) events.close();
    onJob(job);
  });
  events.addEventListener('grasp', ({ data }: MessageEvent<string>) => {
    onGrasp(JSON.parse(data) as Grasp);
  });
  events.addEventListener('error', () => {
    // A browser that goes on trying is no news; one that gave up hides why.
    if (events.readyState !== EventSource.CLOSED) return;
    getJob(id).then(onJob, (error: unknown) => {
      onProblem(toProblem(error));
    });
  });
  return () => {
    events.close();
  };
}
