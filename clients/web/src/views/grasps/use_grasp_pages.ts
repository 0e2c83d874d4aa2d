import { useEffect, useMemo, useState } from 'preact/hooks';

import { queryGrasps } from '../../api/client';
import { type ProblemError, toProblem } from '../../api/problem';
import type { Grasp } from '../../api/types';
import { useResource } from '../../app/resource';
import type { GraspFilters } from '../../app/routes';

/** As many as are asked for at once. */
export const GRASPS_PER_PAGE = 200;

/** A list of grasps that grows by a page at a time. */
export interface GraspPages {
  readonly grasps: readonly Grasp[];
  readonly problem: ProblemError | null;
  /** Nothing is there yet. */
  readonly loading: boolean;
  /** Asks for the next page; null when all are there or it is on its way. */
  readonly loadMore: (() => void) | null;
  readonly reload: () => void;
}

interface FurtherPages {
  readonly grasps: readonly Grasp[];
  readonly cursor: string | null;
  readonly problem: ProblemError | null;
  readonly loading: boolean;
}

/** The grasps that meet the filters, in the server's order. */
export function useGraspPages(filters: GraspFilters): GraspPages {
  const key = JSON.stringify(filters);
  const first = useResource(key, () => queryGrasps({ limit: GRASPS_PER_PAGE, ...filters }));
  const [further, setFurther] = useState<FurtherPages | null>(null);
  // Pages that follow belong to the first one.
  useEffect(() => {
    setFurther(null);
  }, [first.value]);

  const cursor = further ? further.cursor : (first.value?.next_cursor ?? null);
  const loadMore = (): void => {
    if (cursor === null) return;
    const before = further?.grasps ?? [];
    setFurther({ grasps: before, cursor, problem: null, loading: true });
    // An answer that comes when the filters have changed finds `further` gone.
    const settle = (page: FurtherPages) => (now: FurtherPages | null) => now?.cursor === cursor ? page : now;
    queryGrasps({ limit: GRASPS_PER_PAGE, ...filters, cursor }).then(
      ({ items, next_cursor }) => {
        setFurther(settle({
          grasps: [...before, ...items], cursor: next_cursor ?? null, problem: null, loading: false,
        }));
      },
      (error: unknown) => {
        setFurther(settle({ grasps: before, cursor, problem: toProblem(error), loading: false }));
      },
    );
  };
  const grasps = useMemo(
    () => [...(first.value?.items ?? []), ...(further?.grasps ?? [])],
    [first.value, further?.grasps],
  );
  return {
    grasps,
    problem: first.problem ?? further?.problem ?? null,
    loading: first.loading && first.value === null,
    // What is shown while others load belongs to the filters before.
    loadMore: cursor === null || first.loading || further?.loading === true ? null : loadMore,
    reload: further?.problem ? loadMore : first.reload,
  };
}
