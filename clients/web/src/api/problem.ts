import type { Problem } from './types';

/** What the server says when it cannot do what was asked (RFC 9457). */
export class ProblemError extends Error {
  readonly status: number;
  readonly hint: string | null;
  readonly code: string;

  constructor(problem: Pick<Problem, 'status' | 'detail' | 'code'> & { hint?: string | null }) {
    super(problem.detail);
    this.name = 'ProblemError';
    this.status = problem.status;
    this.hint = problem.hint ?? null;
    this.code = problem.code;
  }
}

function isProblem(value: unknown): value is Problem {
  return typeof value === 'object' && value !== null && 'detail' in value && 'code' in value;
}

/** Reads the problem out of an answer that is not a success. */
export async function readProblem(response: Response): Promise<ProblemError> {
  const body: unknown = await response.json().catch(() => null);
  if (isProblem(body)) return new ProblemError(body);
  return new ProblemError({
    status: response.status,
    detail: `The server answered ${response.status} ${response.statusText}.`,
    code: 'unknown',
  });
}

/** Something to show for whatever was thrown. */
export function toProblem(error: unknown): ProblemError {
  if (error instanceof ProblemError) return error;
  if (error instanceof TypeError) {
    return new ProblemError({
      status: 0,
      detail: 'The server cannot be reached.',
      hint: 'Is graspdb serve still running?',
      code: 'unreachable',
    });
  }
  return new ProblemError({
    status: 0,
    detail: error instanceof Error ? error.message : String(error),
    code: 'unknown',
  });
}
