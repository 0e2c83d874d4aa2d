import { useMemo } from 'preact/hooks';

import { getGrasp } from '../../api/client';
import type { Grasp } from '../../api/types';
import { navigate } from '../../app/navigation';
import { useResource } from '../../app/resource';
import type { GraspExtra, Route } from '../../app/routes';
import { ProblemNote } from '../../ui/problem_note';
import { FilterBox } from './filter_box';
import { GraspBench } from './grasp_bench';
import { GraspList } from './grasp_list';
import { useGraspPages } from './use_grasp_pages';

type GraspsRoute = Extract<Route, { view: 'grasps' }>;

/** Stored grasps by filter, best first, and one of them in 3-D. */
export function GraspsView({ route }: { readonly route: GraspsRoute }) {
  const { filters } = route;
  const listed = useGraspPages(filters);
  const { grasps } = listed;
  const chosen = route.grasp ?? grasps[0]?.id;
  const inList = grasps.find(({ id }) => id === chosen);
  // A link may name a grasp that the filters leave out.
  const single = useResource(
    chosen !== undefined && !listed.loading && !inList ? chosen : null,
    () => getGrasp(chosen ?? ''),
  );
  const grasp: Grasp | null = inList ?? single.value;

  // Stepping through grasps is no step of the browser's back button.
  const select = (id: string): void => {
    navigate({ ...route, grasp: id }, { replace: true });
  };
  const show = (extra: GraspExtra | null): void => {
    const { show: before, ...rest } = route;
    navigate(extra === null ? rest : { ...rest, show: extra }, { replace: true });
  };

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
          loading={listed.loading}
          loadMore={listed.loadMore}
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
        onChoose={select}
      />
    </div>
  );
}
