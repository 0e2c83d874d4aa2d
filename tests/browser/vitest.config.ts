import { defineConfig } from 'vitest/config';

export default defineConfig({
  server: { fs: { allow: ['../..'] } },
  test: {
    include: ['*.test.ts'],
    globalSetup: ['support/global_setup.ts'],
    // One browser at a time: rendering is done by the processor.
    fileParallelism: false,
    testTimeout: 120_000,
    hookTimeout: 60_000,
  },
});
