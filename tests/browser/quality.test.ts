/** What holds for every page: accessible, no wider than a phone, steady, strict. */
import { readFileSync } from 'node:fs';

import axe from 'axe-core';
import type { Page } from 'playwright-core';
import { describe, expect, inject, it } from 'vitest';

import { queryGrasps } from './support/seed';
import { useVisitors } from './support/visitor';

const enter = useVisitors();

async function listPages(): Promise<readonly (readonly [name: string, path: string])[]> {
  const { items } = await queryGrasps(inject('url'), 'category=mug&stage=assembly&limit=1');
  const [grasp] = items;
  if (!grasp) throw new Error('There is no grasp to look at.');
  return [
    ['browse', '/?category=mug'],
    ['object', `/?view=object&object=${grasp.object}`],
    ['grasps', '/?view=grasps&category=mug&stage=assembly&show=source'],
    ['upload', '/?view=upload'],
    ['transfer form', `/?view=upload&object=${grasp.object}`],
    ['insight', '/?view=insight&category=mug'],
    ['transfer', `/?view=insight&transfer=${String(grasp.provenance.transfer)}`],
  ];
}

const pages = await listPages();

async function findViolations(page: Page): Promise<string[]> {
  // Evaluated by the debugger, which the content security policy does not bind.
  await page.evaluate(axe.source);
  const { violations } = await page.evaluate(() => (window as unknown as { axe: typeof axe }).axe.run());
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join(' | ')}`);
}

/** How much of the page has jumped since it was opened (0.1 is noticed). */
const measureShift = (page: Page): Promise<number> =>
  page.evaluate(
    () =>
      new Promise<number>((resolve) => {
        new PerformanceObserver((list) => {
          const shifts = list.getEntries() as (PerformanceEntry & { value: number })[];
          resolve(shifts.reduce((sum, { value }) => sum + value, 0));
        }).observe({ type: 'layout-shift', buffered: true });
        setTimeout(resolve, 300, 0);
      }),
  );

describe.each(pages)('%s', (name, path) => {
  it.each([false, true])('is accessible, dark: %s', async (dark) => {
    const visitor = await enter({ dark });
    await visitor.visit(path);
    if (dark) await visitor.picture(`dark-${name.replace(' ', '-')}`);
    expect(await findViolations(visitor.page)).toEqual([]);
  });

  it('fits a phone', async () => {
    const visitor = await enter({ width: 375, height: 812 });
    await visitor.visit(path);
    await visitor.picture(`phone-${name.replace(' ', '-')}`, true);
    expect(await visitor.page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(375);
  });

  it('does not jump while it loads', async () => {
    const visitor = await enter();
    await visitor.visit(path);
    expect(await measureShift(visitor.page)).toBeLessThan(0.1);
  });
});

describe('the server', () => {
  it('serves the page that lies in clients/web/dist', async () => {
    const page = await (await fetch(`${inject('url')}/`)).text();
    expect(page).toBe(readFileSync('../../clients/web/dist/index.html', 'utf8'));
  });

  it('forbids whatever does not come from itself', async () => {
    const { headers } = await fetch(`${inject('url')}/`);
    const policy = headers.get('content-security-policy') ?? '';
    expect(policy).toContain("script-src 'self'");
    expect(policy).not.toContain('unsafe');
  });
});
