import { useCallback, useEffect, useState } from 'preact/hooks';

import { type ProblemError, toProblem } from '../api/problem';

/** Something that comes from the server. While a newer one loads, the one before
 * stays, so that the page keeps its place. */
export interface Resource<Value> {
  readonly value: Value | null;
  readonly problem: ProblemError | null;
  readonly loading: boolean;
  readonly reload: () => void;
}

/** Loads what `key` stands for, again when the key changes; a null key is
 * nothing to load. `load` must depend on the key only. */
export function useResource<Value>(
  key: string | null,
  load: () => Promise<Value>,
): Resource<Value> {
  const [attempt, setAttempt] = useState(0);
  const [state, setState] = useState<Omit<Resource<Value>, 'reload'>>({
    value: null,
    problem: null,
    loading: key !== null,
  });
  useEffect(() => {
    if (key === null) {
      setState({ value: null, problem: null, loading: false });
      return;
    }
    let wanted = true;
    setState(({ value }) => ({ value, problem: null, loading: true }));
    load().then(
      (value) => {
        if (wanted) setState({ value, problem: null, loading: false });
      },
      (error: unknown) => {
        if (wanted) setState({ value: null, problem: toProblem(error), loading: false });
      },
    );
    return () => {
      wanted = false;
    };
  }, [key, attempt]);
  const reload = useCallback(() => {
    setAttempt((n) => n + 1);
  }, []);
  return { ...state, reload };
}
