import {
  type BufferGeometry, ConeGeometry, DoubleSide, Group, InstancedMesh, type Material, Matrix4, MeshBasicMaterial, Quaternion,
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

/** Contacts as dots, each with its friction cone: the directions in which the
 * finger can push the object there, into it, as long as the cone is wide. They
 * show through object and hand, which hide most of them otherwise. */
export class ContactMarks extends Group {
  private readonly meshes: readonly InstancedMesh<BufferGeometry, Material>[];

  constructor(contacts: readonly Contact[], friction: number) {
    super();
    const shared = { color: CONTACT_COLOUR, transparent: true, depthTest: false, depthWrite: false };
    const cones = new InstancedMesh(
      new ConeGeometry(friction * CONE_LENGTH, CONE_LENGTH, 24, 1, true).translate(0, -CONE_LENGTH / 2, 0),
      new MeshBasicMaterial({ ...shared, opacity: 0.28, side: DoubleSide }),
      contacts.length,
    );
    const dots = new InstancedMesh(
      new SphereGeometry(DOT_RADIUS, 12, 8),
      new MeshBasicMaterial({ ...shared, opacity: 0.95 }),
      contacts.length,
    );
    contacts.forEach((contact, index) => {
      const X_OC = makeContactPose(contact);
      cones.setMatrixAt(index, X_OC);
      dots.setMatrixAt(index, X_OC);
    });
    cones.renderOrder = 2;
    dots.renderOrder = 3;
    this.meshes = [cones, dots];
    this.add(cones, dots);
  }

  override dispose(): void {
    super.dispose();
    for (const mesh of this.meshes) {
      mesh.geometry.dispose();
      mesh.material.dispose();
      mesh.dispose();
    }
  }
}
