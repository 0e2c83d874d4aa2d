import { Mesh, MeshStandardMaterial } from 'three';

import { partColour } from '../ui/palette';
import type { ObjectModel } from './object_model';

export interface ObjectLook {
  /** Below 1 what is behind shows through. */
  readonly opacity: number;
  /** The label of the part that stands out; null: all alike. */
  readonly highlighted: string | null;
}

const FADED = 0.18;

/** An object with its parts in colours. The geometry stays the model's. */
export class ObjectMesh extends Mesh {
  private readonly looks: MeshStandardMaterial[];

  constructor(private readonly model: ObjectModel, look: ObjectLook) {
    const colours = model.parts.map(({ colour }) => colour);
    const looks = (colours.length > 0 ? colours : [partColour(-1)]).map(
      (color) => new MeshStandardMaterial({ color, roughness: 0.62, metalness: 0 }),
    );
    const [only] = looks;
    super(model.geometry, colours.length > 0 || only === undefined ? looks : only);
    this.looks = looks;
    this.setLook(look);
  }

  setLook({ opacity, highlighted }: ObjectLook): void {
    this.looks.forEach((material, index) => {
      const label = this.model.parts[index]?.part.label;
      const faded = highlighted !== null && label !== highlighted;
      material.opacity = faded ? Math.min(FADED, opacity) : opacity;
      const transparent = material.opacity < 1;
      if (material.transparent !== transparent) material.needsUpdate = true;
      material.transparent = transparent;
      // What shines through is not to hide the inside of its own walls.
      material.depthWrite = !faded;
    });
  }

  override dispose(): void {
    super.dispose();
    for (const material of this.looks) material.dispose();
  }
}
