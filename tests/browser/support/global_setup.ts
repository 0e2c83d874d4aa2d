import type { TestProject } from 'vitest/node';

import { Graspdb } from './graspdb';
import { seed } from './seed';

declare module 'vitest' {
  interface ProvidedContext {
    /** Where the server is that all tests share. */
    readonly url: string;
  }
}

/** GRASPDB_URL, for whoever works on the viewer: a server that runs already and
 * has the data. */
export default async function setup({ provide }: TestProject): Promise<() => Promise<void>> {
  const running = process.env['GRASPDB_URL'];
  if (running !== undefined) {
    provide('url', running);
    return () => Promise.resolve();
  }
  const graspdb = await Graspdb.start();
  await seed(graspdb.url);
  provide('url', graspdb.url);
  return () => graspdb.stop();
}
