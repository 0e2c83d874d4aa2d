import { AxesHelper, Color } from 'three';

/** Frame O: x red, y green, z blue, as in every robot's viewer. */
export class FrameAxes extends AxesHelper {
  constructor(length: number) {
    super(length);
    this.setColors(new Color('#e0322c'), new Color('#1f9d3a'), new Color('#2f62e8'));
    for (const material of [this.material].flat()) material.depthTest = false;
    this.renderOrder = 1;
  }
}
