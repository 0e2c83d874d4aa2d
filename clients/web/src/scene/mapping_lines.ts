import { BufferGeometry, LineBasicMaterial, LineSegments, type Vector3 } from 'three';

/** Two points of the scene that belong together. */
export interface PointPair {
  readonly from: Vector3;
  readonly to: Vector3;
}

/** A straight line for each pair, seen through everything. */
export class MappingLines extends LineSegments<BufferGeometry, LineBasicMaterial> {
  constructor(pairs: readonly PointPair[], colour: string) {
    super(
      new BufferGeometry().setFromPoints(pairs.flatMap(({ from, to }) => [from, to])),
      new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.9, depthTest: false }),
    );
    this.renderOrder = 4;
  }

  override dispose(): void {
    super.dispose();
    this.geometry.dispose();
    this.material.dispose();
  }
}
