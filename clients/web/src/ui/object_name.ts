import type { StoredObject } from '../api/types';

/** What people call it: its name, else its file, else the start of its id. */
export function describeObject({ name, file_name, id }: StoredObject): string {
  return name || file_name || id.slice(0, 8);
}
