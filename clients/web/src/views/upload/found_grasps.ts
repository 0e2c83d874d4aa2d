import type { Grasp } from '../../api/types';

/** Adds a grasp to those found so far, best first. One that comes again, as it
 * may when it was improved, takes the place of the one before. */
export function addGrasp(found: readonly Grasp[], grasp: Grasp): readonly Grasp[] {
  const others = found.filter(({ id }) => id !== grasp.id);
  const place = others.findIndex(({ quality }) => quality.epsilon < grasp.quality.epsilon);
  const end = place < 0 ? others.length : place;
  return [...others.slice(0, end), grasp, ...others.slice(end)];
}
