import { type ChildProcess, execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, openSync, readFileSync, rmSync, symlinkSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';

const START_LIMIT = 60_000; // ms

/** The path in an environment variable that the entry script sets. */
export function requirePath(name: string): string {
  const path = process.env[name];
  if (path === undefined || !existsSync(path)) throw new Error(`${name} names nothing: ${String(path)}`);
  return path;
}

/** A graspdb of its own on a fresh database that knows the hands only. */
export class Graspdb {
  private constructor(
    private readonly process: ChildProcess,
    private readonly folder: string,
    readonly url: string,
  ) {}

  static async start(): Promise<Graspdb> {
    const binary = requirePath('GRASPDB_BINARY');
    const folder = mkdtempSync(join(tmpdir(), 'graspdb-browser-'));
    const database = join(folder, 'browser.db');
    const portFile = join(folder, 'port');
    const hands = join(folder, 'hands-only');
    mkdirSync(hands);
    symlinkSync(join(requirePath('GRASPDB_DATA'), 'hands'), join(hands, 'hands'));
    execFileSync(binary, ['populate', hands, '--db', database], { stdio: 'ignore' });
    const log = join(folder, 'log');
    const child = spawn(binary, ['serve', '--db', database, '--port', '0', '--port-file', portFile], {
      stdio: ['ignore', 'ignore', openSync(log, 'w')],
    });
    const end = Date.now() + START_LIMIT;
    while (!existsSync(portFile)) {
      if (child.exitCode !== null || Date.now() > end) {
        throw new Error(`graspdb did not start:\n${readFileSync(log, 'utf8')}`);
      }
      await sleep(20);
    }
    return new Graspdb(child, folder, `http://127.0.0.1:${readFileSync(portFile, 'utf8').trim()}`);
  }

  /** Ends it; throws if something had gone wrong inside it. */
  async stop(): Promise<void> {
    const ended = new Promise((resolve) => this.process.once('exit', resolve));
    this.process.kill('SIGTERM');
    await ended;
    const faults = readFileSync(join(this.folder, 'log'), 'utf8')
      .split('\n')
      .filter((line) => line.includes('event=internal'));
    rmSync(this.folder, { recursive: true, force: true });
    if (faults.length > 0) throw new Error(faults.join('\n'));
  }
}
