import { useEffect, useMemo } from 'preact/hooks';

import { getGrasp, queryGrasps } from '../../api/client';
import type { Grasp } from '../../api/types';
import { navigate } from '../../app/navigation';
import { useResource } from '../../app/resource';
import type { GraspExtra, GraspFilters, Route } from '../../app/routes';
import { ProblemNote } from '../../ui/problem_note';
import { FilterBox } from './filter_box';
import { GraspBench } from './grasp_bench';
import { GraspList } from './grasp_list';

/** As many as the view of all grasps shows at once. */
export const MOST_GRASPS = 200;

type GraspsRoute = Extract<Route, { view: 'grasps' }>;

/** The arrows step through the grasps wherever the focus is, but where they
 * already mean something. */
function isTyping(target: EventTarget | null): boolean {
  return target instanceof HTMLElement && target.matches('input, select, textarea, summary');
}

const STEPS: Readonly<Record<string, number>> = {
  ArrowDown: 1,
  ArrowRight: 1,
  ArrowUp: -1,
  ArrowLeft: -1,
  Home: -Infinity,
  End: Infinity,
};

/** Stored grasps by filter, best first, and one of them in 3-D. */
export function GraspsView({ route }: { readonly route: GraspsRoute }) {
  const { filters } = route;
  const listed = useResource(JSON.stringify(filters), () =>
    queryGrasps({ limit: MOST_GRASPS, ...filters }),
  );
  const grasps = listed.value?.items ?? [];
  const chosen = route.grasp ?? grasps[0]?.id;
  const inList = grasps.find(({ id }) => id === chosen);
  // A link may name a grasp that the filters leave out.
  const single = useResource(
    chosen !== undefined && !listed.loading && !inList ? chosen : null,
    () => getGrasp(chosen ?? ''),
  );
  const grasp: Grasp | null = inList ?? single.value;

  const goTo = (next: Partial<Pick<GraspsRoute, 'grasp' | 'show'>> & { filters?: GraspFilters }): void => {
    navigate({ ...route, ...next }, { replace: next.filters === undefined });
  };
  const select = (id: string): void => {
    goTo({ grasp: id });
  };
  const show = (extra: GraspExtra | null): void => {
    const { show: before, ...rest } = route;
    navigate(extra === null ? rest : { ...rest, show: extra }, { replace: true });
  };

  useEffect(() => {
    const step = (event: KeyboardEvent): void => {
      const offset = STEPS[event.key];
      if (offset === undefined || event.shiftKey || event.altKey || event.ctrlKey || event.metaKey) return;
      if (isTyping(event.target) || grasps.length === 0) return;
      event.preventDefault();
      const index = grasps.findIndex(({ id }) => id === chosen);
      const next = grasps[Math.min(Math.max(index + offset, 0), grasps.length - 1)];
      if (next) select(next.id);
    };
    window.addEventListener('keydown', step);
    return () => {
      window.removeEventListener('keydown', step);
    };
  });

  const onSameObject = useMemo(
    () => grasps.filter(({ object, hand }) => object === grasp?.object && hand === grasp.hand),
    [grasps, grasp?.object, grasp?.hand],
  );
  const problem = listed.problem ?? single.problem;
  return (
    <div class="workbench three">
      <div class="workbench-list">
        <h1>Grasps</h1>
        <FilterBox
          filters={filters}
          onChange={(changed) => {
            navigate({ view: 'grasps', filters: changed, ...(route.show && { show: route.show }) });
          }}
        />
        {problem && <ProblemNote problem={problem} retry={listed.reload} />}
        <GraspList
          grasps={grasps}
          loading={listed.loading && listed.value === null}
          more={typeof listed.value?.next_cursor === 'string'}
          chosen={chosen ?? null}
          onChoose={select}
        />
      </div>
      <GraspBench
        grasp={grasp}
        recorded
        others={onSameObject}
        show={route.show ?? null}
        onShow={show}
      />
    </div>
  );
}
