import { defineConfig } from 'vitest/config';

// Development only: `npm run dev` takes /v1 from a server on this port.
const server = process.env['GRASPDB_URL'] ?? 'http://127.0.0.1:8090';

export default defineConfig({
  esbuild: { jsx: 'automatic', jsxImportSource: 'preact' },
  build: {
    target: 'es2022',
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1000,
    rollupOptions: {
      // three changes rarely; a chunk of its own stays in the browser's cache.
      output: { manualChunks: { three: ['three'] } },
    },
  },
  server: {
    proxy: { '/v1': server },
    fs: { allow: ['../..'] }, // Tests read the hand below data/.
  },
  test: { include: ['tests/**/*.test.ts'] },
});
