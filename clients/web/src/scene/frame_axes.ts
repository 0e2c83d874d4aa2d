import { AxesHelper } from 'three';

/** Frame O: x red, y green, z blue, as in every robot's viewer. */
export class FrameAxes extends AxesHelper {
  constructor(length: number) {
    super(length);
    this.renderOrder = 1;
  }
}
