/** The operations of schema/openapi.yaml that the viewer uses, one function each. */
import { readProblem } from './problem';
import type {
  Category, Grasp, GraspQuery, GraspSpace, GraspSpaceQuery, Hand, Job, ObjectQuery, Page,
  Parameter, Part, SettingValues, StoredObject, Transfer, TransferItem, TransferListQuery,
  TransferQuery, UploadQuery,
} from './types';

type QueryValue = string | number | boolean | undefined;

/** Most items that a page of a list can have. */
export const MOST_ITEMS = 1000;

export function withQuery(path: string, query: Readonly<Record<string, QueryValue>> = {}): string {
  const pairs = new URLSearchParams();
  for (const [name, value] of Object.entries(query)) {
    if (value !== undefined && value !== '') pairs.set(name, String(value));
  }
  const text = pairs.toString();
  return text === '' ? path : `${path}?${text}`;
}

async function send(path: string, init: RequestInit = {}): Promise<Response> {
  const response = await fetch(path, init);
  if (!response.ok) throw await readProblem(response);
  return response;
}

// The one place where the contract is trusted: schema and server are tested
// against each other, so that bodies are not checked again here.
async function readJson<Body>(response: Promise<Response>): Promise<Body> {
  return (await (await response).json()) as Body;
}

const getJson = <Body>(path: string): Promise<Body> => readJson<Body>(send(path));

// Of what becomes a job only its end is of interest, however long that takes.
const sendJson = <Body>(method: string, path: string, body: unknown): Promise<Body> =>
  readJson<Body>(
    send(path, {
      method,
      headers: { 'Content-Type': 'application/json', Prefer: 'wait=600' },
      body: JSON.stringify(body),
    }),
  );

const getText = async (path: string): Promise<string> => (await send(path)).text();

export const listCategories = (): Promise<Page<Category>> =>
  getJson(withQuery('/v1/categories', { limit: MOST_ITEMS }));

export const getCategory = (name: string): Promise<Category> =>
  getJson(`/v1/categories/${encodeURIComponent(name)}`);

export const listObjects = (query: ObjectQuery): Promise<Page<StoredObject>> =>
  getJson(withQuery('/v1/objects', { limit: MOST_ITEMS, ...query }));

export const getObject = (id: string): Promise<StoredObject> => getJson(`/v1/objects/${id}`);

/** The repaired mesh: metres, frame O. */
export const getMesh = (id: string): Promise<string> =>
  getText(withQuery(`/v1/objects/${id}/mesh`, { format: 'obj' }));

/** The parts, each with the faces of the object's mesh that are its own. */
export const listParts = (object: string): Promise<Page<Part>> =>
  getJson(`/v1/objects/${object}/parts`);

export const renamePart = (id: string, label: string, cascade: boolean): Promise<StoredObject> =>
  sendJson('PATCH', withQuery(`/v1/parts/${id}`, { cascade }), { label });

export const segmentAgain = (
  id: string,
  settings: SettingValues,
  cascade: boolean,
): Promise<StoredObject> =>
  sendJson('POST', withQuery(`/v1/objects/${id}/segmentation`, { cascade }), { settings });

export const listParameters = (): Promise<{ readonly items: readonly Parameter[] }> =>
  getJson('/v1/parameters');

export const listGraspSpaces = (query: GraspSpaceQuery): Promise<Page<GraspSpace>> =>
  getJson(withQuery('/v1/grasp-spaces', { limit: MOST_ITEMS, ...query }));

export const getGraspSpace = (id: string): Promise<GraspSpace> => getJson(`/v1/grasp-spaces/${id}`);

export const queryGrasps = (query: GraspQuery): Promise<Page<Grasp>> =>
  getJson(withQuery('/v1/grasps', { ...query }));

export const getGrasp = (id: string): Promise<Grasp> => getJson(`/v1/grasps/${id}`);

export const getTransfer = (id: string): Promise<Transfer> => getJson(`/v1/transfers/${id}`);

export const listTransfers = (query: TransferListQuery): Promise<Page<TransferItem>> =>
  getJson(withQuery('/v1/transfers', { ...query }));

export const listHands = (): Promise<Page<Hand>> => getJson('/v1/hands');

export const getUrdf = (hand: string): Promise<string> =>
  getText(`/v1/hands/${encodeURIComponent(hand)}/urdf`);

/** A mesh file that the hand's URDF names. */
export const getHandMesh = (hand: string, file: string): Promise<string> =>
  getText(`/v1/hands/${encodeURIComponent(hand)}/meshes/${encodeURIComponent(file)}`);

/** Stores a file; a form, so that the server sees its name. */
export function postObject(file: File, query: UploadQuery): Promise<StoredObject> {
  const form = new FormData();
  form.append('mesh', file, file.name);
  return readJson(send(withQuery('/v1/objects', { ...query }), { method: 'POST', body: form }));
}

/** Starts a transfer to a stored object and answers at once with its job. */
export const startTransfer = (query: TransferQuery & { object: string }): Promise<Job> =>
  readJson(
    send(withQuery('/v1/grasps', { ...query }), {
      method: 'POST',
      headers: { Prefer: 'respond-async' },
    }),
  );

export const getJob = (id: string): Promise<Job> => getJson(`/v1/jobs/${id}`);

export const cancelJob = (id: string): Promise<Job> =>
  readJson(send(`/v1/jobs/${id}`, { method: 'DELETE' }));
