import { type BufferGeometry, Vector3 } from 'three';
import type { URDFLink } from 'urdf-loader';

/** Where a bone of a link ends; all begin at the link's origin, frame L. */
export type Bones = readonly Vector3[];

/** The skeleton of a link: a bone to each joint that it carries or, at the end of
 * a finger, to the farthest point of its shape. */
export function findBones(link: URDFLink, shape: BufferGeometry | undefined): Bones {
  const joints = link.children.filter((child) => 'isURDFJoint' in child);
  if (joints.length > 0) return joints.map(({ position }) => position.clone());
  const tip = new Vector3();
  const corners = shape?.getAttribute('position');
  const corner = new Vector3();
  for (let i = 0; corners && i < corners.count; ++i) {
    corner.fromBufferAttribute(corners, i);
    if (corner.lengthSq() > tip.lengthSq()) tip.copy(corner);
  }
  return tip.lengthSq() > 0 ? [tip] : [];
}
