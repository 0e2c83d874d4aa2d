import type { ProblemError } from '../api/problem';

interface ProblemNoteProps {
  readonly problem: ProblemError;
  readonly retry?: () => void;
}

/** What went wrong and what to do next, in the server's words. */
export function ProblemNote({ problem, retry }: ProblemNoteProps) {
  return (
    <div class="problem" role="alert">
      <p class="problem-detail">{problem.message}</p>
      {problem.hint !== null && <p class="problem-hint">{problem.hint}</p>}
      {retry && (
        <button type="button" onClick={retry}>
          Try again
        </button>
      )}
    </div>
  );
}
