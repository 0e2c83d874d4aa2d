import { Color, Group, InstancedMesh, Mesh, MeshLambertMaterial, MeshStandardMaterial } from 'three';

import type { HandState } from '../robot/grasp_motion';
import type { HandModel } from '../robot/hand_model';

/** One hand. */
export class HandMesh extends Group {
  private readonly material: MeshStandardMaterial;
  private readonly meshes = new Map<string, Mesh>();

  constructor(private readonly hand: HandModel, colour: string) {
    super();
    this.material = new MeshStandardMaterial({
      color: colour,
      roughness: 0.5,
      metalness: 0.15,
      transparent: true, // Opaque, but drawn after ghosts, so that these do not veil it.
    });
    for (const { geometry, links } of hand.shapes) {
      for (const link of links) {
        const mesh = new Mesh(geometry, this.material);
        mesh.matrixAutoUpdate = false;
        mesh.renderOrder = 1;
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

export interface Ghost {
  readonly state: HandState;
  readonly colour: string;
}

/** So that few hands are clear and many a cloud, densest where most are. */
const calcGhostOpacity = (numGhosts: number): number => 0.45 / Math.sqrt(Math.max(numGhosts, 4));

/** Many hands at once: as many draw calls as the hand has different links. */
export class HandSwarm extends Group {
  private readonly material: MeshLambertMaterial;

  constructor(hand: HandModel, ghosts: readonly Ghost[]) {
    super();
    this.material = new MeshLambertMaterial({
      transparent: true,
      opacity: calcGhostOpacity(ghosts.length),
      depthWrite: false,
    });
    const poses = ghosts.map(({ state }) => hand.calcLinkPoses(state));
    for (const { geometry, links } of hand.shapes) {
      const mesh = new InstancedMesh(geometry, this.material, ghosts.length * links.length);
      let index = 0;
      ghosts.forEach(({ colour }, g) => {
        for (const link of links) {
          const X_OL = poses[g]?.get(link);
          if (X_OL) mesh.setMatrixAt(index, X_OL);
          mesh.setColorAt(index, new Color(colour));
          ++index;
        }
      });
      mesh.frustumCulled = false;
      this.add(mesh);
    }
  }

  override dispose(): void {
    super.dispose();
    for (const mesh of this.children) if (mesh instanceof InstancedMesh) mesh.dispose();
    this.material.dispose();
  }
}
