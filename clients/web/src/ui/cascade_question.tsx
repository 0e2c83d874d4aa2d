import type { ProblemError } from '../api/problem';
import { ProblemNote } from './problem_note';

interface CascadeQuestionProps {
  readonly problem: ProblemError;
  readonly onCascade: () => void;
  readonly onCancel: () => void;
}

/** Why a change was refused; if because grasps depend on what it changes, whether
 * they may go, too. */
export function CascadeQuestion({ problem, onCascade, onCancel }: CascadeQuestionProps) {
  return (
    <>
      <ProblemNote problem={problem} />
      <p class="actions">
        {problem.status === 409 && (
          <button type="button" onClick={onCascade}>
            Change it and delete those grasps
          </button>
        )}
        <button type="button" onClick={onCancel}>
          Leave it
        </button>
      </p>
    </>
  );
}
