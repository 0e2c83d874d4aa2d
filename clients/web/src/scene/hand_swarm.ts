import {
  type BufferGeometry, Color, CylinderGeometry, Group, InstancedMesh, MeshLambertMaterial, Quaternion, Vector3,
} from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

import type { Bones } from '../robot/bones';
import type { HandState } from '../robot/grasp_motion';
import type { HandModel } from '../robot/hand_model';

const RADIUS = 0.0014; // m
const SIDES = 6;
const UP = new Vector3(0, 1, 0);

/** One hand of a swarm. */
export interface Ghost {
  readonly state: HandState;
  readonly colour: string;
}

/** Many hands at once, as skeletons, through which the object can be seen. The
 * geometry of each link is there once; each link is one draw call. */
export class HandSwarm extends Group {
  private readonly material = new MeshLambertMaterial();
  private readonly meshes: readonly InstancedMesh[];

  constructor(hand: HandModel, ghosts: readonly Ghost[]) {
    super();
    const poses = ghosts.map(({ state }) => hand.calcLinkPoses(state));
    const colours = ghosts.map(({ colour }) => new Color(colour));
    this.meshes = [...hand.findBones()].flatMap(([link, bones]) => {
      if (bones.length === 0) return [];
      const mesh = new InstancedMesh(makeGeometry(bones), this.material, ghosts.length);
      poses.forEach((X_OL, index) => {
        const pose = X_OL.get(link);
        const colour = colours[index];
        if (pose) mesh.setMatrixAt(index, pose);
        if (colour) mesh.setColorAt(index, colour);
      });
      mesh.frustumCulled = false; // Its bounds are those of one hand.
      return [mesh];
    });
    this.add(...this.meshes);
  }

  override dispose(): void {
    super.dispose();
    for (const mesh of this.meshes) {
      mesh.geometry.dispose();
      mesh.dispose();
    }
    this.material.dispose();
  }
}

function makeGeometry(bones: Bones): BufferGeometry {
  return mergeGeometries(
    bones.map((end) => {
      const bone = new CylinderGeometry(RADIUS, RADIUS, end.length(), SIDES, 1);
      bone.translate(0, end.length() / 2, 0);
      return bone.applyQuaternion(new Quaternion().setFromUnitVectors(UP, end.clone().normalize()));
    }),
  );
}
