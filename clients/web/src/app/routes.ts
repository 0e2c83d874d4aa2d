/** Everything that a link to the viewer says, and its text: `/?view=…`. */
import type { GraspQuery, GraspStage } from '../api/types';

export type GraspSort = NonNullable<GraspQuery['sort']>;

/** Which grasps are listed, in the words of GET /v1/grasps. */
export interface GraspFilters {
  readonly category?: string;
  readonly object?: string;
  readonly grasp_space?: string;
  readonly transfer?: string;
  readonly part?: string;
  readonly task?: string;
  readonly hand?: string;
  readonly min_epsilon?: number;
  readonly verified?: 'physical';
  readonly stage?: GraspStage;
  readonly sort?: GraspSort;
}

/** What is shown beside a grasp. */
export type GraspExtra = 'source' | 'all';

export type Route =
  | { readonly view: 'browse'; readonly category?: string }
  | { readonly view: 'object'; readonly object: string }
  | {
      readonly view: 'grasps';
      readonly filters: GraspFilters;
      readonly grasp?: string;
      readonly show?: GraspExtra;
    }
  | { readonly view: 'upload'; readonly object?: string; readonly job?: string }
  | { readonly view: 'insight'; readonly category?: string; readonly transfer?: string };

export const STAGES: readonly GraspStage[] = ['learned', 'transfer', 'assembly'];
export const SORTS: readonly GraspSort[] = ['epsilon', 'merit', 'hybrid', 'robust', 'newest'];
const EXTRAS: readonly GraspExtra[] = ['source', 'all'];

function choose<Word extends string>(words: readonly Word[], text: string | null): Word | undefined {
  return words.find((word) => word === text);
}

type Compact<T> = { readonly [K in keyof T]?: Exclude<T[K], undefined> };

/** Leaves out what is undefined, so that optional means absent. */
function compact<T extends object>(value: T): Compact<T> {
  return Object.fromEntries(
    Object.entries(value).filter(([, field]) => field !== undefined),
  ) as Compact<T>;
}

function readFilters(query: URLSearchParams): GraspFilters {
  const text = (name: string): string | undefined => query.get(name) ?? undefined;
  const epsilon = Number(query.get('min_epsilon') ?? '');
  return compact({
    category: text('category'),
    object: text('object'),
    grasp_space: text('grasp_space'),
    transfer: text('transfer'),
    part: text('part'),
    task: text('task'),
    hand: text('hand'),
    min_epsilon: epsilon > 0 ? epsilon : undefined,
    verified: choose(['physical'], query.get('verified')),
    stage: choose(STAGES, query.get('stage')),
    sort: choose(SORTS, query.get('sort')),
  });
}

/** Reads `?…`; whatever is not understood is the start page. */
export function parseRoute(search: string): Route {
  const query = new URLSearchParams(search);
  const text = (name: string): string | undefined => query.get(name) ?? undefined;
  const object = text('object');
  switch (query.get('view')) {
    case 'object':
      if (object === undefined) break;
      return { view: 'object', object };
    case 'grasps':
      return {
        view: 'grasps',
        filters: readFilters(query),
        ...compact({ grasp: text('grasp'), show: choose(EXTRAS, query.get('show')) }),
      };
    case 'upload':
      return { view: 'upload', ...compact({ object, job: text('job') }) };
    case 'insight':
      return {
        view: 'insight',
        ...compact({ category: text('category'), transfer: text('transfer') }),
      };
    default:
      break;
  }
  return { view: 'browse', ...compact({ category: text('category') }) };
}

/** The link to a route; `/` for the start page. */
export function formatRoute(route: Route): string {
  const query = new URLSearchParams();
  const { view, ...rest } = route;
  if (view !== 'browse') query.set('view', view);
  const { filters, ...others } = 'filters' in rest ? rest : { filters: {}, ...rest };
  for (const [name, value] of Object.entries({ ...filters, ...others })) {
    query.set(name, String(value));
  }
  const text = query.toString();
  return text === '' ? '/' : `/?${text}`;
}
