import {
  type Box3, DirectionalLight, HemisphereLight, type Intersection, type Object3D, PerspectiveCamera, Raycaster, Scene,
  Vector2, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

/** What one frame took. */
export interface FrameStatistics {
  readonly drawCalls: number;
  readonly triangles: number;
  readonly milliseconds: number;
}

/** From where a stage is seen at first: from the front, right and above. */
const FIRST_VIEW = new Vector3(0.55, -1, 0.6).normalize();
/** Of what is framed, around it. */
const FRAME_MARGIN = 1.08;
const FIELD_OF_VIEW = 32; // Degrees, as three takes it: long enough a lens to compare lengths.
/** Pixels beyond this per CSS pixel cost much and show little. */
const MOST_PIXELS_RATIO = 2;
/** A pointer that went farther than this between down and up dragged, CSS pixels. */
const CLICK_SLOP = 4;

/** Lights that look the same from every side: they go with the camera. */
export function addLights(scene: Scene, camera: PerspectiveCamera): void {
  const sky = new HemisphereLight('#ffffff', '#aab3bf', 2.1);
  sky.position.set(0, 0, 1);
  const key = new DirectionalLight('#ffffff', 2.3);
  key.position.set(-0.4, 0.6, 1);
  camera.add(key, key.target);
  scene.add(sky, camera);
}

/** Puts the camera so that the box fills its view, seen from `direction`. */
export function frameBox(camera: PerspectiveCamera, box: Box3, direction: Vector3 = FIRST_VIEW): void {
  const centre = box.getCenter(new Vector3());
  camera.up.set(0, 0, 1);
  camera.position.copy(centre).add(direction);
  camera.lookAt(centre);
  const tangent = Math.tan((camera.fov * Math.PI) / 360);
  const toCamera = camera.quaternion.clone().invert();
  let distance = 0;
  for (const corner of listCorners(box)) {
    const { x, y, z } = corner.sub(centre).applyQuaternion(toCamera);
    const across = Math.max(Math.abs(x) / (tangent * camera.aspect), Math.abs(y) / tangent);
    distance = Math.max(distance, z + across);
  }
  camera.position.copy(centre).addScaledVector(direction, distance * FRAME_MARGIN);
  camera.near = distance / 100;
  camera.far = distance * 100;
  camera.updateProjectionMatrix();
}

function listCorners({ min, max }: Box3): Vector3[] {
  return [min.x, max.x].flatMap((x) =>
    [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new Vector3(x, y, z))),
  );
}

/** A canvas in a container, which it fills, showing a scene from a camera that
 * the user turns about z. Draws only when something changed. */
export class Stage {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1);
  private readonly controls: OrbitControls;
  private readonly observer: ResizeObserver;
  private readonly listeners = new Set<(statistics: FrameStatistics) => void>();
  private home: { readonly box: Box3; readonly from: Vector3 } | null = null;
  private request = 0;

  constructor(private readonly container: HTMLElement, label: string) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, MOST_PIXELS_RATIO));
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', label);
    container.append(canvas);
    addLights(this.scene, this.camera);

    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    // Shift and the arrows turn the view; the arrows alone step through grasps.
    this.controls.listenToKeyEvents(canvas);
    this.controls.keyPanSpeed = 0;
    this.controls.addEventListener('change', () => {
      this.invalidate();
    });

    this.observer = new ResizeObserver(() => {
      this.resize();
    });
    this.observer.observe(container);
    this.resize();
  }

  describe(label: string): void {
    this.renderer.domElement.setAttribute('aria-label', label);
  }

  add(content: Object3D): void {
    this.scene.add(content);
    this.invalidate();
  }

  remove(content: Object3D): void {
    this.scene.remove(content);
    this.invalidate();
  }

  /** What reset() goes to: all of the box, seen from that direction. */
  setHome(box: Box3, from: Vector3 = FIRST_VIEW): void {
    this.home = { box: box.clone(), from };
  }

  reset(): void {
    if (!this.home) return;
    frameBox(this.camera, this.home.box, this.home.from);
    this.home.box.getCenter(this.controls.target);
    this.controls.update();
    this.invalidate();
  }

  /** Where a point of the scene lies, in CSS pixels from the upper left corner. */
  project(point: Vector3): { readonly x: number; readonly y: number } {
    const { x, y } = point.clone().project(this.camera);
    const { clientWidth, clientHeight } = this.container;
    return { x: ((1 + x) / 2) * clientWidth, y: ((1 - y) / 2) * clientHeight };
  }

  /** The first of `among` that is not further than a few pixels from a point of
   * the canvas, in CSS pixels from its upper left corner. */
  pick(x: number, y: number, among: Object3D): Intersection | null {
    const { clientWidth, clientHeight } = this.container;
    const raycaster = new Raycaster();
    for (const [dx, dy] of [[0, 0], [CLICK_SLOP, 0], [-CLICK_SLOP, 0], [0, CLICK_SLOP], [0, -CLICK_SLOP]] as const) {
      raycaster.setFromCamera(
        new Vector2((2 * (x + dx)) / clientWidth - 1, 1 - (2 * (y + dy)) / clientHeight),
        this.camera,
      );
      const [first] = raycaster.intersectObject(among);
      if (first) return first;
    }
    return null;
  }

  /** Calls the listener with where the canvas is clicked, in CSS pixels from its
   * upper left corner; to drag is no click. Gives back how to end that. */
  onClick(listener: (x: number, y: number) => void): () => void {
    const canvas = this.renderer.domElement;
    let down: { readonly x: number; readonly y: number } | null = null;
    const press = ({ offsetX: x, offsetY: y }: PointerEvent): void => {
      down = { x, y };
    };
    const release = ({ offsetX: x, offsetY: y }: PointerEvent): void => {
      if (down && Math.hypot(x - down.x, y - down.y) <= CLICK_SLOP) listener(x, y);
      down = null;
    };
    canvas.addEventListener('pointerdown', press);
    canvas.addEventListener('pointerup', release);
    return () => {
      canvas.removeEventListener('pointerdown', press);
      canvas.removeEventListener('pointerup', release);
    };
  }

  /** Calls the listener after each frame; gives back how to end that. */
  onFrame(listener: (statistics: FrameStatistics) => void): () => void {
    this.listeners.add(listener);
    this.invalidate();
    return () => this.listeners.delete(listener);
  }

  /** Draws soon. */
  invalidate(): void {
    if (this.request !== 0) return;
    this.request = requestAnimationFrame(() => {
      this.request = 0;
      this.draw();
    });
  }

  /** Draws now and waits until the picture is there, not only ordered. */
  drawAndFinish(): FrameStatistics {
    const start = performance.now();
    this.renderer.render(this.scene, this.camera);
    const context = this.renderer.getContext();
    // Reading a pixel is the one way to wait that every implementation honours.
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4));
    return this.describeFrame(performance.now() - start);
  }

  dispose(): void {
    cancelAnimationFrame(this.request);
    this.observer.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.renderer.domElement.remove();
  }

  private draw(): void {
    const start = performance.now();
    this.renderer.render(this.scene, this.camera);
    const statistics = this.describeFrame(performance.now() - start);
    for (const listener of this.listeners) listener(statistics);
  }

  private describeFrame(milliseconds: number): FrameStatistics {
    const { calls, triangles } = this.renderer.info.render;
    return { drawCalls: calls, triangles, milliseconds };
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.container;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }
}
