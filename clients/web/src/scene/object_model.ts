import type { BufferGeometry } from 'three';

import { getCategory, getMesh, getObject, listParts } from '../api/client';
import { remember } from '../api/remember';
import type { Part, StoredObject } from '../api/types';
import { makeMeshGeometry } from '../geometry/mesh_geometry';
import { readObj } from '../geometry/read_obj';
import { partColour } from '../ui/palette';

/** A part with the colour that it has everywhere. */
export interface ColouredPart {
  readonly part: Part;
  readonly colour: string;
}

/** An object ready to be drawn, in its own frame O. */
export interface ObjectModel {
  readonly object: StoredObject;
  readonly parts: readonly ColouredPart[];
  /** One group per part, in the order of `parts`; one in all without parts. */
  readonly geometry: BufferGeometry;
}

const loadMesh = remember(async (id: string) => readObj(await getMesh(id)));
const loadPartLabels = remember(async (category: string) =>
  (await getCategory(category)).parts.map(({ label }) => label),
);

export async function loadObjectModel(object: StoredObject): Promise<ObjectModel> {
  const [mesh, labels, { items: parts }] = await Promise.all([
    loadMesh(object.id),
    object.category === null ? Promise.resolve<string[]>([]) : loadPartLabels(object.category),
    listParts(object.id),
  ]);
  const groups = parts.length > 0 ? parts.map(({ faces = [] }) => faces) : undefined;
  return {
    object,
    parts: parts.map((part) => ({ part, colour: partColour(labels.indexOf(part.label)) })),
    geometry: makeMeshGeometry(mesh, groups),
  };
}

export const loadObjectModelById = async (id: string): Promise<ObjectModel> =>
  loadObjectModel(await getObject(id));
