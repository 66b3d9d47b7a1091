import { readdir, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';
import { defineConfig } from 'vite';

const TEXT = /\.(html|js|css|svg|json)$/;

/** Compressed forms beside each text file, once, so that serving compresses nothing. */
function compressed() {
  let folder = '';
  return {
    name: 'compressed',
    apply: 'build',
    configResolved(config) {
      folder = config.build.outDir;
    },
    async closeBundle() {
      const names = await readdir(folder, { recursive: true });
      for (const name of names.filter((one) => TEXT.test(one))) {
        const file = join(folder, name);
        const bytes = await readFile(file);
        const quality = { params: { [constants.BROTLI_PARAM_QUALITY]: 11 } };
        await writeFile(`${file}.br`, brotliCompressSync(bytes, quality));
        await writeFile(`${file}.gz`, gzipSync(bytes, { level: 9 }));
      }
    },
  };
}

// DENAVIT_SERVICE is the service that `npm run dev` shows.
const service = process.env.DENAVIT_SERVICE ?? 'http://localhost:8000';

// Modules of the first screen: all but the entry, what is opened later, and the languages.
const LATER = [
  /node_modules/,
  /\/src\/(main|solve|target|dialog|key-dialog|reproduction|api\/motion|api\/files)\.ts$/,
  /\/src\/(files|stage|panels\/path)\//,
  /\/src\/panels\/(ik|reproduce)\.ts$/,
  /\/src\/table\/(paste|placements)\.ts$/,
  /\/src\/i18n\/(later\.)?(en|fr)\.ts$/,
  /\/src\/scene\/(?!types\.ts$)/,
];
const isShell = (id) => /\/web\/src\/.*\.ts$/.test(id) && !LATER.some((one) => one.test(id));

export default defineConfig({
  base: './',
  build: {
    outDir: process.env.DENAVIT_PAGE ?? '../app/static',
    emptyOutDir: true,
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    reportCompressedSize: false,
    chunkSizeWarningLimit: 1500,
    // The first screen as one file; what is opened later, and each language, as files of their own.
    rolldownOptions: { output: { codeSplitting: { groups: [{ name: 'shell', test: isShell }] } } },
  },
  plugins: [compressed()],
  test: { include: ['test/**/*.test.ts'], setupFiles: ['test/setup.ts'] },
  server: { proxy: { '/v1': service, '/docs': service, '/openapi.json': service } },
});
