import { useEffect, useState } from 'preact/hooks';
import { Box3 } from 'three';

import { getCategory, getObject } from '../../api/client';
import type { StoredObject } from '../../api/types';
import { Link } from '../../app/navigation';
import { useDark } from '../../app/media';
import { useResource } from '../../app/resource';
import { FloorGrid, GRID_CELL } from '../../scene/floor_grid';
import { FrameAxes } from '../../scene/frame_axes';
import { loadObjectModel } from '../../scene/object_model';
import { ObjectMesh } from '../../scene/object_mesh';
import type { Stage } from '../../scene/stage';
import { useOnStage, Viewport } from '../../scene/viewport';
import { describeObject } from '../../ui/object_name';
import { PartLegend } from '../../ui/part_legend';
import { ProblemNote } from '../../ui/problem_note';
import { gridColour } from '../../ui/palette';
import { ObjectFacts } from './object_facts';
import { PartsPanel } from './parts_panel';
import { SegmentationPanel } from './segmentation_panel';

/** What identifies the state of an object's parts. */
const keyOfParts = ({ id, parts = [] }: StoredObject): string =>
  [id, ...parts.map((part) => part.id)].join(' ');

export function ObjectView({ id }: { readonly id: string }) {
  const dark = useDark();
  const loaded = useResource(id, () => getObject(id));
  const [changed, setChanged] = useState<StoredObject | null>(null);
  const object = changed ?? loaded.value;
  const model = useResource(object && keyOfParts(object), async () => {
    if (!object) throw new Error('There is no object to draw.');
    return loadObjectModel(object);
  });
  const category = useResource(object?.category ?? null, () => getCategory(object?.category ?? ''));
  const [stage, setStage] = useState<Stage | null>(null);
  const [highlighted, setHighlighted] = useState<string | null>(null);

  const geometry = model.value?.geometry;
  useEffect(() => {
    if (!stage || !geometry?.boundingBox) return;
    stage.setHome(geometry.boundingBox);
    stage.reset();
  }, [stage, id, geometry !== undefined]);
  useEffect(() => () => geometry?.dispose(), [geometry]);
  const mesh = useOnStage(
    stage,
    () => model.value && new ObjectMesh(model.value, { opacity: 1, highlighted: null }),
    [model.value],
  );
  useEffect(() => {
    mesh?.setLook({ opacity: 1, highlighted });
    stage?.invalidate();
  }, [mesh, highlighted]);
  useOnStage(
    stage,
    () => (geometry ? new FloorGrid(geometry.boundingBox ?? new Box3(), gridColour(dark)) : null),
    [geometry, dark],
  );
  useOnStage(stage, () => (geometry ? new FrameAxes(GRID_CELL) : null), [geometry]);

  if (loaded.problem) {
    return <div class="page"><ProblemNote problem={loaded.problem} retry={loaded.reload} /></div>;
  }
  const name = object ? describeObject(object) : '…';
  return (
    <div class="workbench">
      <div class="workbench-stage">
        <Viewport label={`The object ${name} with its parts in colours`} onStage={setStage}>
          <div class="viewport-legend">
            <PartLegend parts={model.value?.parts ?? []} />
            <p>Grid {GRID_CELL} m · axes of frame O: x red, y green, z blue</p>
          </div>
        </Viewport>
        {model.problem && <ProblemNote problem={model.problem} retry={model.reload} />}
      </div>
      <div class="workbench-panel">
        <h1>{name}</h1>
        {!object && <div class="skeleton panel-skeleton" aria-hidden="true" />}
        {object && (
          <>
            <p class="subtitle">
              {object.role === 'example' ? 'Example' : 'Novel object'}
              {object.category !== null && (
                <> of <Link to={{ view: 'browse', category: object.category }}>{object.category}</Link></>
              )}
            </p>
            <p class="actions">
              <Link
                class="button primary"
                to={{ view: 'grasps', filters: { object: object.id, sort: 'epsilon' } }}
              >
                Grasps on it
              </Link>
              {object.role === 'novel' && object.category !== null && (
                <Link class="button" to={{ view: 'upload', object: object.id }}>
                  Transfer grasps to it
                </Link>
              )}
            </p>
            <PartsPanel
              object={object}
              parts={model.value?.parts ?? []}
              labels={category.value?.parts.map(({ label }) => label) ?? []}
              onHighlight={setHighlighted}
              onChange={setChanged}
            />
            <ObjectFacts object={object} />
            {category.value && (
              <SegmentationPanel object={object} category={category.value} onChange={setChanged} />
            )}
          </>
        )}
      </div>
    </div>
  );
}
