import type { Attempt } from '../../api/types';

export const SUCCEEDED = 'succeeded';

/** How an attempt ended: at which stage, for which reason. */
export function describeOutcome({ transfer, assembly }: Attempt): string {
  if (transfer !== SUCCEEDED) return `part: ${transfer.replaceAll('_', ' ')}`;
  if (assembly !== null && assembly !== SUCCEEDED) return `whole: ${assembly.replaceAll('_', ' ')}`;
  return SUCCEEDED;
}

export interface OutcomeCounts {
  /** Success first, then the commonest. */
  readonly outcomes: readonly string[];
  /** By part, one count per outcome. */
  readonly counts: ReadonlyMap<string, readonly number[]>;
}

export function countOutcomes(attempts: readonly Attempt[]): OutcomeCounts {
  const totals = new Map<string, number>([[SUCCEEDED, 0]]);
  for (const attempt of attempts) {
    const outcome = describeOutcome(attempt);
    totals.set(outcome, (totals.get(outcome) ?? 0) + 1);
  }
  const outcomes = [...totals.keys()].sort(
    (a, b) =>
      Number(b === SUCCEEDED) - Number(a === SUCCEEDED) || (totals.get(b) ?? 0) - (totals.get(a) ?? 0),
  );
  const counts = new Map<string, number[]>();
  for (const attempt of attempts) {
    const own = counts.get(attempt.part) ?? new Array<number>(outcomes.length).fill(0);
    const row = outcomes.indexOf(describeOutcome(attempt));
    own[row] = (own[row] ?? 0) + 1;
    counts.set(attempt.part, own);
  }
  return { outcomes, counts };
}
