// Builds dist/page.html from src/ with esbuild: script and style inline, their hashes in the
// Content-Security-Policy, the licences of the libraries at the end of the script.
//
//   npm ci && npm run build            writes dist/page.html
//   node build.mjs --check             fails unless dist/page.html is what src/ gives
import {build} from 'esbuild';
import {createHash} from 'node:crypto';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const folder = dirname(fileURLToPath(import.meta.url));

const bundled = async (entry) => {
  const result = await build({
    absWorkingDir: folder,
    bundle: true,
    charset: 'utf8',
    entryPoints: [entry],
    external: [],
    format: entry.endsWith('.css') ? undefined : 'iife',
    legalComments: 'eof',
    minify: true,
    target: ['es2022'],
    write: false,
  });
  return result.outputFiles[0].text.trim();
};

const script = await bundled('src/main.js');
const style = await bundled('src/style.css');
for (const [text, end] of [[script, '</script'], [style, '</style']]) {
  if (text.toLowerCase().includes(end)) throw new Error(`the bundle contains ${end}`);
}
const hash = text => `sha256-${createHash('sha256').update(text, 'utf8').digest('base64')}`;
const parts = {
  '@SCRIPT_HASH@': hash(script),
  '@STYLE_HASH@': hash(style),
  '@SCRIPT@': script,
  '@STYLE@': style,
};
// One pass: nothing in a bundle is taken for a mark.
const page = readFileSync(join(folder, 'src/page.html'), 'utf8')
                 .replace(/@(SCRIPT_HASH|STYLE_HASH|SCRIPT|STYLE)@/g, mark => parts[mark]);
if (page.split('@DATA@').length !== 2) throw new Error('the mark of the data is not unique');

const file = join(folder, 'dist/page.html');
if (process.argv.includes('--check')) {
  const same = readFileSync(file, 'utf8') === page;
  console.log(same ? 'dist/page.html is what src/ gives' : 'dist/page.html differs: npm run build');
  process.exit(same ? 0 : 1);
}
mkdirSync(dirname(file), {recursive: true});
writeFileSync(file, page);
console.log(`dist/page.html: ${(page.length / 1000).toFixed(0)} kB`);
