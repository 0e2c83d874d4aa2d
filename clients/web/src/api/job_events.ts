import { getJob } from './client';
import { type ProblemError, toProblem } from './problem';
import type { Grasp, Job } from './types';

export interface JobListener {
  readonly onJob: (job: Job) => void;
  /** As soon as it is found; after a reconnection perhaps once more. */
  readonly onGrasp: (grasp: Grasp) => void;
  readonly onProblem: (problem: ProblemError) => void;
}

const PAUSE = 1000; // ms, before a refused stream is asked for again.

export const isFinished = ({ state }: Job): boolean => state !== 'queued' && state !== 'running';

/** Follows a job's event stream until the job has finished; gives back how to
 * stop before. A broken connection is taken up again by the browser itself; a
 * stream that was refused, say by a server that has too much to do, is asked for
 * again here, for as long as the server tells of the job itself. */
export function followJob(id: string, { onJob, onGrasp, onProblem }: JobListener): () => void {
  let events: EventSource;
  let again: ReturnType<typeof setTimeout>;
  let stopped = false;
  const stop = (): void => {
    stopped = true;
    clearTimeout(again);
    events.close();
  };
  const take = (job: Job): void => {
    if (stopped) return;
    if (isFinished(job)) stop();
    else if (events.readyState === EventSource.CLOSED) again = setTimeout(connect, PAUSE);
    onJob(job);
  };
  const connect = (): void => {
    events = new EventSource(`/v1/jobs/${id}/events`);
    events.addEventListener('job', ({ data }: MessageEvent<string>) => {
      take(JSON.parse(data) as Job);
    });
    events.addEventListener('grasp', ({ data }: MessageEvent<string>) => {
      onGrasp(JSON.parse(data) as Grasp);
    });
    events.addEventListener('error', () => {
      // A browser that goes on trying is no news; one that gave up hides why.
      if (events.readyState !== EventSource.CLOSED) return;
      getJob(id).then(take, (error: unknown) => {
        if (!stopped) onProblem(toProblem(error));
      });
    });
  };
  connect();
  return stop;
}
