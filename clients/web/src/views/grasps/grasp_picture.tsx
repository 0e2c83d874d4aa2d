import { useEffect, useMemo, useState } from 'preact/hooks';
import { Box3, Vector3 } from 'three';

import type { Grasp } from '../../api/types';
import { useDark } from '../../app/media';
import { useResource } from '../../app/resource';
import { calcHandState } from '../../robot/grasp_motion';
import { loadHandModel } from '../../robot/hand_model';
import { ContactMarks } from '../../scene/contact_marks';
import { FloorGrid, GRID_CELL } from '../../scene/floor_grid';
import { HandMesh } from '../../scene/hand_mesh';
import { HandSwarm } from '../../scene/hand_swarm';
import type { ObjectModel } from '../../scene/object_model';
import { ObjectMesh } from '../../scene/object_mesh';
import { placeBeside } from '../../scene/place_beside';
import type { Stage } from '../../scene/stage';
import { SceneLabel } from '../../scene/scene_label';
import { useOnStage, Viewport } from '../../scene/viewport';
import { describeObject } from '../../ui/object_name';
import { CONTACT_COLOUR, gridColour, handColour, lineColour, rampColour } from '../../ui/palette';
import { PartLegend } from '../../ui/part_legend';
import { Swatch } from '../../ui/swatch';
import { formatNumber } from '../../ui/format';
import { chooseDirection, chooseDirectionAcross, HAND_ROOM, makeBoxOfMotion } from './framing';
import { makeMappingLines, SourceGroup, type SourceOfGrasp } from './source_group';

interface GraspPictureProps {
  readonly grasp: Grasp | null;
  readonly model: ObjectModel | null;
  /** Null: not known yet; contacts then have no cones. */
  readonly friction: number | null;
  /** 0 at the pre-grasp, 1 at the grasp. */
  readonly progress: number;
  /** All to be shown at once, as ghosts; null: only the one. */
  readonly ghosts: readonly Grasp[] | null;
  readonly source: SourceOfGrasp | null;
  /** A ghost was clicked. */
  readonly onChoose: (id: string) => void;
}

const boxOf = (model: ObjectModel): Box3 => model.geometry.boundingBox ?? new Box3();
const bottomOf = (box: Box3): Vector3 => box.getCenter(new Vector3()).setZ(box.min.z);

/** A grasp on its object. */
export function GraspPicture({ grasp, model, friction, progress, ghosts, source, onChoose }: GraspPictureProps) {
  const dark = useDark();
  const [stage, setStage] = useState<Stage | null>(null);
  const hand = useResource(grasp?.hand ?? null, () => loadHandModel(grasp?.hand ?? ''));
  const ready = model !== null && grasp !== null && model.object.id === grasp.object;

  // Where the example stands: left of the object, turned as the object is.
  const X_OE = useMemo(
    () => (ready && source ? placeBeside(boxOf(model), boxOf(source.model), source.contactMap.X_NE) : null),
    [ready, source?.model, source?.contactMap, model],
  );

  useEffect(() => {
    if (!stage || !ready) return;
    if (X_OE && source) {
      const box = boxOf(source.model).clone().applyMatrix4(X_OE).union(boxOf(model));
      stage.setHome(box.expandByScalar(HAND_ROOM), chooseDirectionAcross(grasp));
    } else if (ghosts) {
      stage.setHome(boxOf(model).clone().expandByScalar(HAND_ROOM), chooseDirection(grasp));
    } else {
      stage.setHome(makeBoxOfMotion(boxOf(model), grasp), chooseDirection(grasp));
    }
  }, [stage, ready, grasp, model, X_OE, ghosts !== null]);
  // Stepping through grasps leaves the view as it is; the button brings it round.
  useEffect(() => {
    if (ready) stage?.reset();
  }, [stage, ready, model?.object.id, X_OE, ghosts !== null]);

  useOnStage(
    stage,
    () => (model ? new ObjectMesh(model, { opacity: 1, highlighted: null }) : null),
    [model],
  );
  useOnStage(stage, () => (model ? new FloorGrid(boxOf(model), gridColour(dark)) : null), [model, dark]);

  const handMesh = useOnStage(
    stage,
    () => (hand.value && ready ? new HandMesh(hand.value, handColour(dark)) : null),
    [hand.value, ready, dark],
  );
  useEffect(() => {
    if (!handMesh || !grasp) return;
    handMesh.setState(calcHandState(grasp, progress));
    stage?.invalidate();
  }, [handMesh, grasp, progress]);

  useOnStage(
    stage,
    () => (ready ? new ContactMarks(grasp.contacts, friction) : null),
    [ready, grasp, friction],
  );

  const best = Math.max(...(ghosts ?? []).map(({ quality }) => quality.epsilon), Number.EPSILON);
  const swarm = useOnStage(
    stage,
    () =>
      hand.value && ready && ghosts
        ? new HandSwarm(
            hand.value,
            ghosts.map((ghost) => ({
              state: calcHandState(ghost, 1),
              colour: rampColour(ghost.quality.epsilon / best),
            })),
          )
        : null,
    [hand.value, ready, ghosts],
  );
  useEffect(() => {
    if (!stage || !swarm || !ghosts) return;
    return stage.onClick((x, y) => {
      const ghost = ghosts[stage.pick(x, y, swarm)?.instanceId ?? -1];
      if (ghost) onChoose(ghost.id);
    });
  }, [stage, swarm, ghosts, onChoose]);

  useOnStage(
    stage,
    () =>
      hand.value && X_OE && source
        ? new SourceGroup(source, X_OE, new HandMesh(hand.value, handColour(dark)), friction)
        : null,
    [hand.value, X_OE, source?.grasp, friction, dark],
  );
  useOnStage(
    stage,
    () => (X_OE && source && ready ? makeMappingLines(source, grasp, X_OE, lineColour(dark)) : null),
    [X_OE, source?.grasp, grasp, ready, dark],
  );

  const name = model ? describeObject(model.object) : '…';
  return (
    <Viewport
      label={grasp ? `A hand grasping ${name} by its ${grasp.part}` : 'No grasp'}
      onStage={setStage}
    >
      {stage && X_OE && source && model && (
        <>
          <SceneLabel stage={stage} point={bottomOf(boxOf(model))}>{name}</SceneLabel>
          <SceneLabel stage={stage} point={bottomOf(boxOf(source.model)).applyMatrix4(X_OE)}>
            example {describeObject(source.model.object)}
          </SceneLabel>
        </>
      )}
      <div class="viewport-legend">
        <PartLegend parts={model?.parts ?? []} />
        <ul class="legend">
          <li><Swatch colour={CONTACT_COLOUR} /> contact{friction !== null && `, friction cone μ = ${friction}`}</li>
          {source && <li><Swatch colour={lineColour(dark)} /> contact → mapped contact</li>}
          {ghosts && (
            <li>
              <Swatch colour={rampColour(0)} /> ε 0 … <Swatch colour={rampColour(1)} /> {formatNumber(best, 2)},{' '}
              {ghosts.length} grasps; click one
            </li>
          )}
        </ul>
        <p>Grid {GRID_CELL} m</p>
      </div>
    </Viewport>
  );
}
