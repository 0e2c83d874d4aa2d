import { useEffect, useState } from 'preact/hooks';

import { getGrasp } from '../../api/client';
import type { Grasp, GraspStage } from '../../api/types';
import { useResource } from '../../app/resource';
import type { GraspExtra } from '../../app/routes';
import { loadObjectModelById } from '../../scene/object_model';
import { ProblemNote } from '../../ui/problem_note';
import { GraspDetails } from './grasp_details';
import { GraspPicture } from './grasp_picture';
import { loadLineage } from './lineage';
import { MotionControl } from './motion_control';
import { StageSwitch } from './stage_switch';

interface GraspBenchProps {
  readonly grasp: Grasp | null;
  /** Whether the record that it comes from is stored; not while it is made. */
  readonly recorded: boolean;
  /** Listed grasps of the same hand on the same object. */
  readonly others: readonly Grasp[];
  readonly show: GraspExtra | null;
  readonly onShow: (extra: GraspExtra | null) => void;
  /** One of the others is chosen. */
  readonly onChoose: (id: string) => void;
}

/** One grasp: picture, motion, comparison with where it comes from, numbers. */
export function GraspBench({ grasp, recorded, others, show, onShow, onChoose }: GraspBenchProps) {
  const lineage = useResource(grasp && recorded ? grasp.id : null, () => {
    if (!grasp) throw new Error('There is no grasp to follow.');
    return loadLineage(grasp);
  });
  const [progress, setProgress] = useState(1);
  // Before or after replanning, as long as the same grasp is chosen.
  const [stage, setStage] = useState<GraspStage | null>(null);
  useEffect(() => {
    setProgress(1);
    setStage(null);
  }, [grasp?.id]);
  const otherId = stage !== null && stage !== grasp?.stage ? (lineage.value?.stages[stage] ?? null) : null;
  const other = useResource(otherId, () => getGrasp(otherId ?? ''));
  const shown = otherId === null ? grasp : (other.value ?? grasp);

  const source = show === 'source' ? (lineage.value?.source ?? null) : null;
  const model = useResource(shown?.object ?? null, () => loadObjectModelById(shown?.object ?? ''));
  const sourceModel = useResource(source?.object ?? null, () => loadObjectModelById(source?.object ?? ''));
  useEffect(() => () => model.value?.geometry.dispose(), [model.value]);
  useEffect(() => () => sourceModel.value?.geometry.dispose(), [sourceModel.value]);
  const problem = model.problem ?? sourceModel.problem ?? lineage.problem ?? other.problem;
  return (
    <>
      <div class="workbench-stage">
        <GraspPicture
          grasp={shown}
          model={model.value}
          friction={lineage.value?.friction ?? null}
          progress={progress}
          ghosts={show === 'all' ? others : null}
          onChoose={onChoose}
          source={
            source && sourceModel.value && lineage.value?.contactMap
              ? { grasp: source, model: sourceModel.value, contactMap: lineage.value.contactMap }
              : null
          }
        />
        <div class="bench-controls">
          <MotionControl progress={progress} onProgress={setProgress} disabled={!shown} />
          <StageSwitch
            stages={lineage.value?.stages ?? {}}
            current={stage ?? grasp?.stage ?? null}
            onStage={setStage}
          />
          <div class="toggles" role="group" aria-label="Show as well">
            <button
              type="button"
              aria-pressed={show === 'source'}
              disabled={lineage.value?.source === null || !recorded}
              onClick={() => { onShow(show === 'source' ? null : 'source'); }}
            >
              Source grasp
            </button>
            <button
              type="button"
              aria-pressed={show === 'all'}
              onClick={() => { onShow(show === 'all' ? null : 'all'); }}
            >
              All grasps
            </button>
          </div>
        </div>
        {problem && <ProblemNote problem={problem} />}
      </div>
      <div class="workbench-panel">
        {shown ? (
          <GraspDetails grasp={shown} source={lineage.value?.source ?? null} />
        ) : (
          <div class="skeleton panel-skeleton" aria-hidden="true" />
        )}
      </div>
    </>
  );
}
