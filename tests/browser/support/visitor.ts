import { mkdirSync } from 'node:fs';
import { join } from 'node:path';

import { type Browser, type BrowserContext, chromium, type Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, inject } from 'vitest';

import { requirePath } from './graspdb';

const FLAGS = [
  '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync',
  // WebGL by the processor.
  '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
];

/** For what needs no grasp to be computed. */
const ACTION_LIMIT = 15_000; // ms

export interface VisitOptions {
  readonly width?: number;
  readonly height?: number;
  readonly dark?: boolean;
  /** Answers that the test provokes; any other error fails it. */
  readonly expectedStatus?: number;
}

/** Someone who looks at the viewer, and hears when anything goes wrong. */
export class Visitor {
  readonly complaints: string[] = [];

  private constructor(readonly page: Page, private readonly context: BrowserContext) {}

  static async open(browser: Browser, options: VisitOptions): Promise<Visitor> {
    const { width = 1400, height = 900, dark = false, expectedStatus } = options;
    const context = await browser.newContext({
      baseURL: inject('url'),
      viewport: { width, height },
      colorScheme: dark ? 'dark' : 'light',
      permissions: ['clipboard-read', 'clipboard-write'],
    });
    context.setDefaultTimeout(ACTION_LIMIT);
    const page = await context.newPage();
    const visitor = new Visitor(page, context);
    const expected = expectedStatus === undefined ? null : `status of ${expectedStatus}`;
    page.on('console', (message) => {
      if (message.type() !== 'error') return;
      if (expected === null || !message.text().includes(expected)) visitor.complaints.push(message.text());
    });
    page.on('pageerror', (error) => visitor.complaints.push(error.message));
    return visitor;
  }

  /** Goes to a page and waits until all that it shows has come. */
  async visit(path: string): Promise<void> {
    await this.page.goto(path);
    await this.settle();
  }

  /** The page asks for nothing any more and has drawn what it got. */
  async settle(): Promise<void> {
    await this.page.waitForLoadState('networkidle');
    await this.page.evaluate(
      () => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve, 200))),
    );
  }

  /** Keeps a picture, if pictures are wanted. */
  async picture(name: string, fullPage = false): Promise<void> {
    const folder = process.env['GRASPDB_SCREENSHOTS'];
    if (folder === undefined) return;
    mkdirSync(folder, { recursive: true });
    await this.page.screenshot({ path: join(folder, `${name}.png`), fullPage });
  }

  async close(): Promise<void> {
    await this.context.close();
  }
}

/** To be called at the top of a test file: gives each test its visitors, and
 * fails it if one of them had to complain. */
export function useVisitors(): (options?: VisitOptions) => Promise<Visitor> {
  let browser: Browser;
  let visitors: Visitor[] = [];
  beforeAll(async () => {
    browser = await chromium.launch({ executablePath: requirePath('CHROMIUM'), args: FLAGS });
  });
  afterEach(async () => {
    const complaints = visitors.flatMap((visitor) => visitor.complaints);
    await Promise.all(visitors.map((visitor) => visitor.close()));
    visitors = [];
    expect(complaints, 'errors on the console').toEqual([]);
  });
  afterAll(() => browser.close());
  return async (options = {}) => {
    const visitor = await Visitor.open(browser, options);
    visitors.push(visitor);
    return visitor;
  };
}
