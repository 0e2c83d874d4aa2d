import { Group, type Matrix4 } from 'three';

import type { ContactMap, Grasp } from '../../api/types';
import { pairContacts } from '../../robot/contact_pairs';
import { calcHandState } from '../../robot/grasp_motion';
import { toSimilarity, toVector } from '../../robot/pose';
import { ContactMarks } from '../../scene/contact_marks';
import type { HandMesh } from '../../scene/hand_mesh';
import { MappingLines } from '../../scene/mapping_lines';
import type { ObjectModel } from '../../scene/object_model';
import { ObjectMesh } from '../../scene/object_mesh';

/** Where a transferred grasp comes from, to be shown beside it. */
export interface SourceOfGrasp {
  readonly grasp: Grasp;
  readonly model: ObjectModel;
  readonly contactMap: ContactMap;
}

/** The example with the source grasp, at X_OE. */
export class SourceGroup extends Group {
  private readonly pieces: readonly { dispose(): void }[];

  constructor({ grasp, model }: SourceOfGrasp, X_OE: Matrix4, hand: HandMesh, friction: number | null) {
    super();
    const object = new ObjectMesh(model, { opacity: 1, highlighted: null });
    const contacts = new ContactMarks(grasp.contacts, friction);
    this.add(object, hand.setState(calcHandState(grasp, 1)), contacts);
    this.pieces = [object, hand, contacts];
    this.applyMatrix4(X_OE);
  }

  override dispose(): void {
    super.dispose();
    for (const piece of this.pieces) piece.dispose();
  }
}

/** From the source grasp's contacts to where they were mapped, and on to where the
 * transferred grasp touches. */
export function makeMappingLines(
  { grasp: source, contactMap: { X_NE, scale } }: SourceOfGrasp,
  grasp: Grasp,
  X_OE: Matrix4,
  colour: string,
): MappingLines {
  const pairs = pairContacts(source.contacts, grasp.contacts, toSimilarity(X_NE, scale));
  const mapped = pairs.map(({ p_E, p_N }) => ({ from: p_E.clone().applyMatrix4(X_OE), to: p_N }));
  const reached = grasp.contacts.flatMap(({ p_O, mapped_p_O }) =>
    mapped_p_O === null ? [] : [{ from: toVector(mapped_p_O), to: toVector(p_O) }],
  );
  return new MappingLines([...mapped, ...reached], colour);
}
