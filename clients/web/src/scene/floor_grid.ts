import { type Box3, GridHelper, Vector3 } from 'three';

/** Side of a cell, m. */
export const GRID_CELL = 0.05;

/** A level grid below a box, for a sense of scale. Its lines lie on multiples of
 * the cell in frame O. */
export class FloorGrid extends GridHelper {
  constructor(box: Box3, colour: string) {
    const size = box.getSize(new Vector3());
    const cells = 2 * Math.ceil((Math.max(size.x, size.y) * 1.6) / (2 * GRID_CELL)) + 2;
    super(cells * GRID_CELL, cells, colour, colour);
    const centre = box.getCenter(new Vector3());
    const snap = (x: number): number => Math.round(x / GRID_CELL) * GRID_CELL;
    this.renderOrder = -1;
    this.rotation.x = Math.PI / 2;
    this.position.set(snap(centre.x), snap(centre.y), box.min.z);
    for (const material of [this.material].flat()) {
      material.depthTest = false; // A hand may be below it; the grid stays behind all.
      material.depthWrite = false;
    }
  }
}
