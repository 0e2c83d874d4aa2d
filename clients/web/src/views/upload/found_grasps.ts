import type { Grasp } from '../../api/types';

/** Adds a grasp to those found so far, best first. One that comes again, as it
 * may after a reconnection, changes nothing. */
export function addGrasp(found: readonly Grasp[], grasp: Grasp): readonly Grasp[] {
  if (found.some(({ id }) => id === grasp.id)) return found;
  const place = found.findIndex(({ quality }) => quality.epsilon < grasp.quality.epsilon);
  const end = place < 0 ? found.length : place;
  return [...found.slice(0, end), grasp, ...found.slice(end)];
}
