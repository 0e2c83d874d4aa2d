/** What people do with the viewer. */
import type { Page } from 'playwright-core';
import { beforeAll, describe, expect, inject, it } from 'vitest';

import { queryGrasps, readMug, upload } from './support/seed';
import { useVisitors } from './support/visitor';

const enter = useVisitors();
const url = inject('url');

const JOB_LIMIT = 110_000; // ms

const option = (page: Page, index: number) => page.locator('li[role=option]').nth(index);
const chosen = (page: Page) => page.locator('li[aria-selected=true]');
const part = (page: Page) => page.getByRole('combobox', { name: 'Part', exact: true });
const bench = (page: Page) => page.locator('.workbench-panel');

describe('from the start page', () => {
  it('a category leads to its objects, an object to its grasps, the arrows from grasp to grasp', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit('/');
    await page.getByText('Mugs and cups with one handle').click();
    await page.getByRole('heading', { name: 'Examples' }).waitFor();
    await visitor.settle();
    await page.locator('.thumbnail.is-drawn').nth(2).waitFor();
    await visitor.picture('browse', true);

    await page.getByRole('link', { name: 'latte.obj' }).click();
    await page.getByRole('heading', { name: 'latte.obj' }).waitFor();
    await visitor.settle();
    expect(await page.locator('.viewport-legend').textContent()).toContain('handle');
    expect(await page.getByText('None was needed.').count()).toBe(1);
    await visitor.picture('object');

    await page.getByRole('link', { name: 'Grasps on it' }).click();
    await option(page, 1).waitFor();
    await visitor.settle();
    const first = await chosen(page).getAttribute('id');
    await page.keyboard.press('ArrowDown');
    await visitor.settle();
    expect(await chosen(page).getAttribute('id')).not.toBe(first);
    await page.keyboard.press('ArrowUp');
    expect(await chosen(page).getAttribute('id')).toBe(first);
    await page.keyboard.press('End');
    expect(await option(page, -1).getAttribute('aria-selected')).toBe('true');
  });
});

describe('a grasp', () => {
  const GRASPS = '/?view=grasps&category=mug&stage=assembly&sort=epsilon';

  it('is listed by quality and copied as the JSON that the server has', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit(GRASPS);
    await visitor.picture('grasps');
    const shown = await page.locator('.grasp-epsilon').allTextContents();
    expect(shown.map(Number)).toEqual(shown.map(Number).sort((a, b) => b - a));
    await page.getByRole('button', { name: 'Copy JSON' }).click();
    await page.getByText('Copied').waitFor();
    const copied: unknown = JSON.parse(await page.evaluate(() => navigator.clipboard.readText()));
    const { items } = await queryGrasps(url, 'category=mug&stage=assembly&sort=epsilon&limit=1');
    // JSON.stringify knows no negative zero.
    expect(copied).toEqual(JSON.parse(JSON.stringify(items[0])));
  });

  it('moves from its pre-grasp to its contacts', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit(GRASPS);
    const slider = page.getByRole('slider');
    await slider.fill('0');
    await visitor.settle();
    await visitor.picture('pregrasp');
    await page.getByRole('button', { name: 'Play' }).click();
    await page.waitForFunction(() => document.querySelector<HTMLInputElement>('input[type=range]')?.value === '1');
  });

  it('stands beside the source grasp that it comes from', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit(GRASPS);
    await page.getByRole('button', { name: 'Source grasp' }).click();
    await page.getByText('example classic').waitFor();
    await visitor.settle();
    expect(page.url()).toContain('show=source');
    await visitor.picture('source');
  });

  it('is shown as before it was replanned for the whole object', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit(GRASPS);
    await page.getByRole('button', { name: 'Before replanning' }).click();
    await bench(page).getByRole('heading', { name: 'body · transfer' }).waitFor();
    await visitor.settle();
    await visitor.picture('before-replanning');
    await page.getByRole('button', { name: 'After replanning' }).click();
    await bench(page).getByRole('heading', { name: 'body · assembly' }).waitFor();
  });

  it('is one of all, which are shown at once', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit(`${GRASPS}&show=all`);
    await page.getByText(/\d+ grasps; click one/).waitFor();
    await visitor.picture('all');
    // Somewhere on the picture a skeleton that is not the chosen one is hit.
    const first = await chosen(page).getAttribute('id');
    const canvas = page.locator('.viewport canvas');
    const { width = 0, height = 0 } = (await canvas.boundingBox()) ?? {};
    for (let y = 0.1 * height; y < 0.9 * height; y += 12) {
      for (let x = 0.2 * width; x < 0.8 * width; x += 12) {
        await canvas.click({ position: { x, y } });
        if ((await chosen(page).getAttribute('id')) !== first) return;
      }
    }
    expect.unreachable('no click chose another grasp');
  });

  it('is followed by more when the first page of them is not all', async () => {
    const visitor = await enter();
    const { page } = visitor;
    const { items } = await queryGrasps(url, 'category=mug&stage=assembly&sort=epsilon');
    expect(items.length).toBeGreaterThan(3);
    // The server's own pages, made short.
    await page.route('**/v1/grasps?*', (route) =>
      route.continue({ url: route.request().url().replace('limit=200', 'limit=2') }));
    await visitor.visit(GRASPS);
    expect(await page.locator('li[role=option]').count()).toBe(2);
    await page.getByRole('button', { name: 'More' }).click();
    await option(page, 3).waitFor();
    const listed = await page.locator('li[role=option]').evaluateAll((all) => all.map(({ id }) => id));
    expect(listed).toEqual(items.slice(0, 4).map(({ id }) => `grasp-${id}`));
  });

  it('comes back from its link, filters and all', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit(GRASPS);
    await option(page, 2).click();
    await part(page).selectOption('body');
    await page.getByLabel('ε at least').fill('0.01');
    await page.getByLabel('ε at least').blur();
    await visitor.settle();
    await option(page, 1).click();
    const id = await chosen(page).getAttribute('id');
    const other = await enter();
    await other.visit(page.url());
    expect(await chosen(other.page).getAttribute('id')).toBe(id);
    expect(await part(other.page).inputValue()).toBe('body');
    expect(await other.page.getByLabel('ε at least').inputValue()).toBe('0.01');
  });

  it('that does not exist is a problem that can be read', async () => {
    const visitor = await enter({ expectedStatus: 404 });
    await visitor.visit('/?view=object&object=01a2037c-478c-7000-a389-2d681db16009');
    expect(await visitor.page.getByRole('alert').textContent()).toMatch(/01a2037c/);
  });
});

/** What has stood in the page's status line; a text of a moment, too. */
async function recordStatus(page: Page): Promise<() => Promise<string[]>> {
  const texts = await page.evaluateHandle(() => {
    const seen = new Set<string>();
    new MutationObserver(() => {
      document.querySelectorAll('[role=status]').forEach((each) => seen.add(each.textContent));
    }).observe(document.body, { subtree: true, childList: true, characterData: true });
    return seen;
  });
  return () => texts.evaluate((seen) => [...seen]);
}

describe('an upload', () => {
  it('is watched while its grasps are found', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit('/?view=upload');
    const readStatus = await recordStatus(page);
    await page.locator('input[type=file]').setInputFiles({
      name: 'square.obj', mimeType: 'model/obj', buffer: readMug('square.obj'),
    });
    await page.getByLabel('Category').selectOption('mug');
    await page.getByLabel('Source grasps per part').fill('10');
    await page.getByLabel('Grasps wanted').fill('6');
    await page.getByRole('button', { name: 'Find grasps' }).click();
    await page.getByText(/so far|^Succeeded/).waitFor({ timeout: JOB_LIMIT });
    await page.waitForTimeout(1500); // For the picture: the stream never lets the network rest.
    await visitor.picture('upload-running');
    await page.getByText(/^Succeeded: [1-9]/).waitFor({ timeout: JOB_LIMIT });
    expect(await readStatus()).toContainEqual(expect.stringMatching(/^[1-9]\d* grasps? so far/));
    await visitor.settle();
    await visitor.picture('upload-done');
    const id = new URL(page.url()).searchParams.get('job') ?? '';
    const job = (await (await page.request.get(`/v1/jobs/${id}`)).json()) as {
      result: { href: string };
    };
    const transfer = (await (await page.request.get(job.result.href)).json()) as {
      enough: number | null;
    };
    expect(transfer.enough).toBe(6);
    expect(await option(page, 0).count()).toBe(1);
    // The link still works when the job has ended.
    await visitor.visit(page.url());
    await page.getByText(/^Succeeded: [1-9]/).waitFor({ timeout: JOB_LIMIT });
  });

  it('is watched though the server refuses the stream at first', async () => {
    const visitor = await enter({ expectedStatus: 503 });
    const { page } = visitor;
    await page.route('**/events', (route) => route.fulfill({ status: 503 }), { times: 2 });
    await visitor.visit('/?view=upload');
    await page.locator('input[type=file]').setInputFiles({
      name: 'square.obj', mimeType: 'model/obj', buffer: readMug('square.obj'),
    });
    await page.getByLabel('Category').selectOption('mug');
    await page.getByLabel('Source grasps per part').fill('10');
    await page.getByRole('button', { name: 'Find grasps' }).click();
    await page.getByText(/^Succeeded: [1-9]/).waitFor({ timeout: JOB_LIMIT });
  });

  it('is given up when it is cancelled', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit('/?view=upload');
    await page.locator('input[type=file]').setInputFiles({
      name: 'bowl.obj', mimeType: 'model/obj', buffer: readMug('bowl.obj'),
    });
    await page.getByLabel('Category').selectOption('mug');
    await page.getByRole('button', { name: 'Find grasps' }).click();
    await page.getByRole('button', { name: 'Cancel' }).click();
    await page.getByText(/^Cancelled/).waitFor();
    expect(await page.getByRole('button', { name: 'Cancel' }).count()).toBe(0);
  });

  it('may be dropped, and in the wrong unit is refused with a hint', async () => {
    const visitor = await enter({ expectedStatus: 422 });
    const { page } = visitor;
    await visitor.visit('/?view=upload');
    const transfer = await page.evaluateHandle((text) => {
      const files = new DataTransfer();
      files.items.add(new File([text], 'latte.obj'));
      return files;
    }, readMug('latte.obj').toString());
    await page.dispatchEvent('.drop-zone', 'drop', { dataTransfer: transfer });
    await page.getByText('latte.obj').waitFor();
    await page.getByLabel('Units').selectOption('mm');
    await page.getByRole('button', { name: 'Find grasps' }).click();
    const problem = page.getByRole('alert');
    await problem.waitFor();
    expect(await problem.textContent()).toContain('try units=m');
  });

  it('of what is no mesh says what is wrong and what to do', async () => {
    const visitor = await enter({ expectedStatus: 422 });
    const { page } = visitor;
    await visitor.visit('/?view=upload');
    await page.locator('input[type=file]').setInputFiles({
      name: 'broken.stl', mimeType: 'model/stl', buffer: Buffer.from('no mesh'),
    });
    await page.getByRole('button', { name: 'Find grasps' }).click();
    const problem = page.getByRole('alert');
    await problem.waitFor();
    expect(await problem.textContent()).toMatch(/STL/);
    expect(await problem.textContent()).toMatch(/Send a mesh/);
    await visitor.picture('upload-refused');
  });
});

describe('an object', () => {
  let object: string;
  beforeAll(async () => {
    object = (await upload(url, 'bowl.obj', 'category=mug')).id;
  });

  it('has a part renamed, then is cut into parts again', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit(`/?view=object&object=${object}`);
    const labels = page.getByLabel(/^Label of the part/);
    expect(await labels.count()).toBe(2);
    await page.getByLabel('Label of the part handle').selectOption('body');
    await page.waitForFunction(() => document.querySelectorAll('.parts select').length === 1);

    await page.getByText('Segment again').first().click();
    await page.getByRole('button', { name: 'Segment again' }).click();
    await page.getByLabel('Label of the part handle').waitFor();
    await visitor.settle();
    expect(await labels.count()).toBe(2);
  });

  it('that grasps depend on keeps its parts unless they may go', async () => {
    const visitor = await enter({ expectedStatus: 409 });
    const { page } = visitor;
    const cone = (await upload(url, 'cone.obj', 'category=mug')).id;
    await (await fetch(`${url}/v1/grasps?object=${cone}&sources=2&count=1`, {
      method: 'POST', headers: { Prefer: 'wait=600' },
    })).arrayBuffer();
    const count = async () => (await queryGrasps(url, `object=${cone}`)).items.length;
    const before = await count();
    expect(before).toBeGreaterThan(0);
    await visitor.visit(`/?view=object&object=${cone}`);
    await page.getByLabel('Label of the part body').selectOption('handle');
    await page.getByRole('button', { name: 'Leave it' }).click();
    await visitor.settle();
    expect(await count()).toBe(before);
    await page.getByLabel('Label of the part body').selectOption('handle');
    await page.getByRole('button', { name: 'Change it and delete those grasps' }).click();
    await page.waitForFunction(() => document.querySelectorAll('.parts select').length === 1);
    expect(await count()).toBe(0);
  });
});

describe('insight', () => {
  it('draws every chart with its axes', async () => {
    const visitor = await enter();
    const { page } = visitor;
    await visitor.visit('/?view=insight&category=mug');
    for (const title of [
      'Quality of the grasps', 'Novel object against example', 'Why grasps were rejected', 'Learning curves',
      'Directions from which a part is grasped',
    ]) {
      expect(await page.getByRole('img', { name: title }).count(), title).toBe(1);
    }
    expect(await page.getByRole('img', { name: /above the diagonal/ }).locator('circle').count()).toBeGreaterThan(0);
    await visitor.picture('insight', true);
    await page.getByRole('table').getByRole('link').first().click();
    await page.getByRole('heading', { name: 'Transfer' }).waitFor();
    await visitor.settle();
    await visitor.picture('transfer', true);
  });
});
