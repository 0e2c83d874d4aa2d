import {
  type BufferGeometry, ConeGeometry, DoubleSide, Group, InstancedMesh, type Material, Matrix4, MeshBasicMaterial,
  type MeshBasicMaterialParameters, Quaternion,
  SphereGeometry, Vector3,
} from 'three';

import type { Contact } from '../api/types';
import { toVector } from '../robot/pose';
import { CONTACT_COLOUR } from '../ui/palette';

const CONE_LENGTH = 0.025; // m
const DOT_RADIUS = 0.0016; // m
const UP = new Vector3(0, 1, 0);

/** X_OC: C at the contact with y along the outward normal. */
function makeContactPose({ p_O, n_O }: Contact): Matrix4 {
  const rotation = new Quaternion().setFromUnitVectors(UP, toVector(n_O).normalize());
  return new Matrix4().compose(toVector(p_O), rotation, new Vector3(1, 1, 1));
}

/** Contacts as dots, each with its friction cone when the friction is known: the
 * directions in which the finger can push the object there, into it. They show
 * through object and hand, which hide most of them otherwise. */
export class ContactMarks extends Group {
  private readonly meshes: InstancedMesh<BufferGeometry, Material>[] = [];

  constructor(contacts: readonly Contact[], friction: number | null) {
    super();
    const poses = contacts.map(makeContactPose);
    this.mark(poses, new SphereGeometry(DOT_RADIUS, 12, 8), { opacity: 0.95 }, 3);
    if (friction === null) return;
    const cone = new ConeGeometry(friction * CONE_LENGTH, CONE_LENGTH, 24, 1, true);
    cone.translate(0, -CONE_LENGTH / 2, 0); // Its tip at the contact.
    this.mark(poses, cone, { opacity: 0.28, side: DoubleSide }, 2);
  }

  override dispose(): void {
    super.dispose();
    for (const mesh of this.meshes) {
      mesh.geometry.dispose();
      mesh.material.dispose();
      mesh.dispose();
    }
  }

  private mark(
    poses: readonly Matrix4[],
    geometry: BufferGeometry,
    look: MeshBasicMaterialParameters,
    renderOrder: number,
  ): void {
    const material = new MeshBasicMaterial({
      color: CONTACT_COLOUR,
      transparent: true,
      depthTest: false,
      depthWrite: false,
      ...look,
    });
    const mesh = new InstancedMesh<BufferGeometry, Material>(geometry, material, poses.length);
    poses.forEach((X_OC, index) => { mesh.setMatrixAt(index, X_OC); });
    mesh.renderOrder = renderOrder;
    this.meshes.push(mesh);
    this.add(mesh);
  }
}
