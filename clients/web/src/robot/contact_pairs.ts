import type { Matrix4, Vector3 } from 'three';

import type { Contact } from '../api/types';
import { toVector } from './pose';

/** A contact of the source grasp, on the example E, and where it was mapped to on
 * the novel object N. */
export interface ContactPair {
  readonly p_E: Vector3;
  readonly p_N: Vector3;
}

/** Pairs the source grasp's contacts with the mapped points of the transferred
 * grasp: of the same link, nearest to where the similarity map_NE of the contact
 * map puts them. Each source contact stands in one pair at most. */
export function pairContacts(
  source: readonly Contact[],
  transferred: readonly Contact[],
  map_NE: Matrix4,
): ContactPair[] {
  const candidates = transferred.flatMap(({ link, mapped_p_O }) => {
    if (mapped_p_O === null) return [];
    const p_N = toVector(mapped_p_O);
    return source
      .filter((contact) => contact.link === link)
      .map((contact) => {
        const p_E = toVector(contact.p_O);
        return { p_E, p_N, key: mapped_p_O.join(), contact, gap: p_E.clone().applyMatrix4(map_NE).distanceTo(p_N) };
      });
  });
  candidates.sort((a, b) => a.gap - b.gap);
  const takenTargets = new Set<string>();
  const takenContacts = new Set<Contact>();
  const pairs: ContactPair[] = [];
  for (const { p_E, p_N, key, contact } of candidates) {
    if (takenTargets.has(key) || takenContacts.has(contact)) continue;
    takenTargets.add(key);
    takenContacts.add(contact);
    pairs.push({ p_E, p_N });
  }
  return pairs;
}
