// Renders docs/capture.png, the first picture of README.md: a frame of the page of a plan.
//
//   node web/picture.mjs build/ci/stillbase docs/capture.png     (needs chromium)
import {execFileSync} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

import {Chromium} from '../tests/report/chromium.mjs';

const kProblem = 'problems/iiwa_client_50.yaml';
const kTime = -2;  // s from the contact: hand and feature close, the impulse ahead

const root = dirname(dirname(fileURLToPath(import.meta.url)));
const [tool, picture] = process.argv.slice(2).map(each => resolve(each));
const folder = mkdtempSync(join(tmpdir(), 'stillbase-picture-'));
const run = (...words) =>
    execFileSync(tool, words, {cwd: folder, stdio: ['ignore', 'pipe', 'pipe']});
run('plan', join(root, kProblem), '-o', 'plan.json');
run('report', 'plan.json', '-o', 'plan.html');
const browser = await Chromium.start();
const page = await browser.open(
    join(folder, 'plan.html'), {width: 1280, height: 800, fragment: `t=${kTime}`});
await page.evaluate(`(() => {
  const frame = document.querySelector('.scene-frame');
  document.querySelector('.hud').remove();
  document.querySelector('.viewer').style.border = 0;
  document.querySelector('article').viewer.clearance = false;
  frame.style.height = '500px';
  frame.scrollIntoView();
})()`);
await page.evaluate(`new Promise(resolve => setTimeout(resolve, 1500))`);
const clip = await page.evaluate(`(() => {
  const {x, y, width, height} = document.querySelector('.scene-frame').getBoundingClientRect();
  return {x, y: y + scrollY, width, height, scale: 1};
})()`);
writeFileSync(picture, await page.screenshot(clip));
await browser.close();
rmSync(folder, {recursive: true, force: true});
