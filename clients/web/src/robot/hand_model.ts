import { type BufferGeometry, Group, Matrix4, type Object3D } from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import URDFLoader, { type URDFRobot } from 'urdf-loader';

import { getHandMesh, getUrdf } from '../api/client';
import { makeMeshGeometry } from '../geometry/mesh_geometry';
import { readObj } from '../geometry/read_obj';
import { remember } from '../api/remember';
import { type Bones, findBones } from './bones';
import type { HandState } from './grasp_motion';

/** A link's shape. Links of the same meshes (the fingers') share one. */
interface LinkShape {
  readonly geometry: BufferGeometry;
  readonly links: readonly string[];
}

/** A hand as its URDF describes it; frame H is the URDF's root link. */
export class HandModel {
  constructor(
    private readonly robot: URDFRobot,
    /** Every link that has a shape is in exactly one of them. */
    readonly shapes: readonly LinkShape[],
  ) {}

  /** The bones of each link by name. */
  findBones(): ReadonlyMap<string, Bones> {
    return new Map(
      Object.entries(this.robot.links).map(([name, link]) => {
        const shape = this.shapes.find(({ links }) => links.includes(name));
        return [name, findBones(link, shape?.geometry)];
      }),
    );
  }

  /** X_OL of each link by name. */
  calcLinkPoses({ X_OH, joints }: HandState): ReadonlyMap<string, Matrix4> {
    for (const [name, value] of Object.entries(joints)) this.robot.setJointValue(name, value);
    this.robot.updateMatrixWorld(true);
    const poses = new Map<string, Matrix4>();
    for (const [name, link] of Object.entries(this.robot.links)) {
      poses.set(name, new Matrix4().multiplyMatrices(X_OH, link.matrixWorld));
    }
    return poses;
  }
}

/** Reads a URDF without its meshes; each visual keeps its file's name.
 *
 * Mimicry is switched off: an answer of the server has every joint, also those
 * that broke away from the one that they follow, and setting the leader must not
 * move them again. Limits are the server's affair. */
export function parseUrdf(urdf: string): URDFRobot {
  const loader = new URDFLoader();
  loader.loadMeshCb = (url, _manager, _material, onLoad) => {
    const place = new Group();
    place.userData['file'] = url.split('/').at(-1);
    onLoad(place);
  };
  const robot = loader.parse(urdf);
  for (const joint of Object.values(robot.joints)) {
    joint.mimicJoints = [];
    joint.ignoreLimits = true;
  }
  return robot;
}

interface Visual {
  readonly file: string;
  readonly X_LV: Matrix4;
}

function findVisuals(link: Object3D): Visual[] {
  const visuals: Visual[] = [];
  for (const child of link.children) {
    if (!('isURDFVisual' in child)) continue;
    child.updateMatrix();
    for (const mesh of child.children) {
      mesh.updateMatrix();
      const file: unknown = mesh.userData['file'];
      if (typeof file !== 'string') continue;
      visuals.push({ file, X_LV: new Matrix4().multiplyMatrices(child.matrix, mesh.matrix) });
    }
  }
  return visuals;
}

async function makeLinkGeometry(hand: string, visuals: readonly Visual[]): Promise<BufferGeometry> {
  const pieces = await Promise.all(
    visuals.map(async ({ file, X_LV }) => {
      const mesh = await loadHandMesh(hand, file);
      return makeMeshGeometry(mesh).applyMatrix4(X_LV);
    }),
  );
  return mergeGeometries(pieces);
}

const loadHandMesh = remember(async (hand: string, file: string) =>
  readObj(await getHandMesh(hand, file)),
);

/** A hand with its shapes, loaded once. */
export const loadHandModel = remember(async (hand: string): Promise<HandModel> => {
  const robot = parseUrdf(await getUrdf(hand));
  const alike = new Map<string, { visuals: readonly Visual[]; links: string[] }>();
  for (const [name, link] of Object.entries(robot.links)) {
    const visuals = findVisuals(link);
    if (visuals.length === 0) continue;
    const key = JSON.stringify(visuals.map(({ file, X_LV }) => [file, X_LV.elements]));
    const entry = alike.get(key);
    if (entry) entry.links.push(name);
    else alike.set(key, { visuals, links: [name] });
  }
  const shapes = await Promise.all(
    [...alike.values()].map(async ({ visuals, links }) => ({
      geometry: await makeLinkGeometry(hand, visuals),
      links,
    })),
  );
  return new HandModel(robot, shapes);
});
