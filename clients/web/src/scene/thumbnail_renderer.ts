import { Box3, Color, PerspectiveCamera, Scene, WebGLRenderer } from 'three';

import type { StoredObject } from '../api/types';
import { loadObjectModel, type ObjectModel } from './object_model';
import { ObjectMesh } from './object_mesh';
import { addLights, frameBox } from './stage';

const FIELD_OF_VIEW = 28; // Degrees, as three takes it.

/** The one renderer for all small pictures: browsers allow few WebGL contexts. */
class ThumbnailRenderer {
  private readonly renderer = new WebGLRenderer({ antialias: true, alpha: true });
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1);

  constructor() {
    addLights(this.scene, this.camera);
    this.renderer.setClearColor(new Color(0), 0);
  }

  /** Draws the object and copies the picture to the canvas. */
  draw(model: ObjectModel, canvas: HTMLCanvasElement): void {
    const { width, height } = canvas;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    const mesh = new ObjectMesh(model, { opacity: 1, highlighted: null });
    this.scene.add(mesh);
    frameBox(this.camera, model.geometry.boundingBox ?? new Box3());
    this.renderer.render(this.scene, this.camera);
    this.scene.remove(mesh);
    mesh.dispose();
    canvas.getContext('2d')?.drawImage(this.renderer.domElement, 0, 0);
  }
}

let shared: ThumbnailRenderer | null = null;

/** Draws a stored object to a 2-D canvas, unless that is not wanted any more. */
export async function drawThumbnail(
  object: StoredObject,
  canvas: HTMLCanvasElement,
  isWanted: () => boolean,
): Promise<void> {
  const model = await loadObjectModel(object);
  if (isWanted()) {
    shared ??= new ThumbnailRenderer();
    shared.draw(model, canvas);
  }
  model.geometry.dispose();
}
