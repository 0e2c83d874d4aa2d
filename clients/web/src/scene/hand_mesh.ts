import { Group, Mesh, MeshStandardMaterial } from 'three';

import type { HandState } from '../robot/grasp_motion';
import type { HandModel } from '../robot/hand_model';

/** One hand. */
export class HandMesh extends Group {
  private readonly material: MeshStandardMaterial;
  private readonly meshes = new Map<string, Mesh>();

  constructor(private readonly hand: HandModel, colour: string) {
    super();
    this.material = new MeshStandardMaterial({ color: colour, roughness: 0.5, metalness: 0.15 });
    for (const { geometry, links } of hand.shapes) {
      for (const link of links) {
        const mesh = new Mesh(geometry, this.material);
        mesh.matrixAutoUpdate = false;
        this.meshes.set(link, mesh);
        this.add(mesh);
      }
    }
  }

  setState(state: HandState): this {
    for (const [link, X_OL] of this.hand.calcLinkPoses(state)) {
      const mesh = this.meshes.get(link);
      if (!mesh) continue;
      mesh.matrix.copy(X_OL);
      mesh.matrixWorldNeedsUpdate = true;
    }
    return this;
  }

  override dispose(): void {
    super.dispose();
    this.material.dispose();
  }
}
