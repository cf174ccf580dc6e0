// Pages of `stillbase report` in headless Chromium: what they say and draw, silence on console and
// network, hostile names, browsers without WebGL, sizes.
//
//   node --test tests/report/page_in_chromium.mjs    with STILLBASE_TOOL and STILLBASE_SOURCE_DIR
//   set
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {cpSync, mkdirSync, mkdtempSync, readFileSync, renameSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {after, before, test as unlimited} from 'node:test';

import {Chromium} from './chromium.mjs';

const tool = resolve(process.env.STILLBASE_TOOL);
const source = resolve(process.env.STILLBASE_SOURCE_DIR);
const folder = mkdtempSync(join(tmpdir(), 'stillbase-report-'));
const path = name => join(folder, name);
const run = (...words) =>
    execFileSync(tool, words, {cwd: folder, stdio: ['ignore', 'pipe', 'pipe'], timeout: 120_000});
const json = name => JSON.parse(readFileSync(path(name), 'utf8'));

const limit = {
  timeout: 120_000
};
const test = (name, use) => unlimited(name, limit, use);

let browser;

before(async () => {
  run('plan', join(source, 'problems/iiwa_client_50.yaml'), '-o', 'plan.json');
  run('verify', 'plan.json', '-o', 'verdict.json');
  run('report', 'plan.json', 'verdict.json', '-o', 'plan.html');
  browser = await Chromium.start();
}, limit);

after(async () => {
  await browser?.close();
  rmSync(folder, {recursive: true, force: true});
}, limit);

/// Opens a page, does something with it, and holds it to silence and its width.
async function opened(name, options, use, chromium = browser) {
  const page = await chromium.open(path(name), options);
  try {
    await page.evaluate(
        'new Promise(resolve => requestAnimationFrame(() => setTimeout(resolve, 50)))');
    await use(page);
    assert.deepEqual(page.messages, [], 'console');
    assert.deepEqual(page.requests, [], 'network');
    assert.equal(page.dialogs, 0);
    assert.equal(
        await page.evaluate('document.documentElement.scrollWidth <= innerWidth'), true,
        'nothing is off-screen');
  } finally {
    await page.close();
  }
}

const text = page => page.evaluate('document.body.innerText');
const scene = async page => {
  await page.evaluate(`document.querySelector('.viewer').scrollIntoView()`);
  await page.evaluate(
      `new Promise(resolve => { const wait = () => document.querySelector('[data-ready]') ? resolve() : setTimeout(wait, 20); wait(); })`);
};

test('a page of a plan opens, scene included, in less than a second of its thread', async () => {
  const page = await browser.open('/dev/null', {width: 1280, height: 800});
  // Ticks of the thread, not of the clock: a machine with other work shows the same.
  await page.send('Performance.enable', {timeDomain: 'threadTicks'});
  const spent = async () => (await page.send('Performance.getMetrics'))
                                .metrics.find(each => each.name === 'TaskDuration')
                                .value;
  const begin = await spent();
  await page.load(`file://${path('plan.html')}`);
  await scene(page);
  const time = await spent() - begin;
  await page.close();
  assert.ok(time < 1, `${time} s`);
});

test('a page of a plan with its verification is below 2 MB', () => {
  assert.ok(statSync(path('plan.html')).size < 2e6, `${statSync(path('plan.html')).size} bytes`);
});

test(
    'a plan says first what was decided, how good and how sure it is, and what binds', async () => {
      await opened('plan.html', {width: 1200}, async page => {
        const words = await text(page);
        const order = [
          'iiwa_client_50', 'Verified: ', 'What was decided', 'How good it is', 'How sure it is',
          'The capture', 'Joint torques', 'What could go wrong', 'What binds', 'After the contact',
          'Better candidates', 'Verification', 'Inputs'
        ];
        order.reduce((from, part) => {
          const at = words.indexOf(part, from);
          assert.ok(at >= 0, `'${part}' in its order`);
          return at;
        }, 0);
        assert.match(words, /worst case over the cone/);
        assert.match(words, /joint_7 may have any angle from -\d/, 'the free roll');
        assert.match(words, /° \(any from −145\.0° to 145\.0°\)/, 'its range in the table');
        assert.ok(words.includes(json('plan.json').content_sha256));
        assert.equal(await page.evaluate(`document.querySelectorAll('.plot').length`), 11);
      });
    });

test('no column is off-screen from 360 to 1920 px, in light and dark', async () => {
  for (const width of [360, 800, 1200, 1920]) {
    await opened('plan.html', {width, dark: width === 800}, async page => {
      await scene(page);
      const wide =
          await page.evaluate(`[...document.querySelectorAll('.plot, .viewer, .tiles, section')]
          .filter(each => each.getBoundingClientRect().right > innerWidth + 1).length`);
      assert.equal(wide, 0);
    });
  }
});

test('at every sample the page has the hand where the planner has it', async () => {
  await opened('plan.html', {}, async page => {
    await scene(page);
    const [samples, worst] = await page.evaluate(`(() => {
      const {viewer} = document.querySelector('article');
      const feature = viewer.data.target.features.find(each => each.name === viewer.data.target.feature);
      const {times, distances} = viewer.motion.approach;
      let worst = 0;
      times.forEach((time, i) => {
        const state = viewer.motion.at(time, 0);
        viewer.view.robot.move(state);
        const point = viewer.view.robot.hand.position.clone().set(...feature.point)
            .applyQuaternion(state.target.quaternion).add(state.target.position);
        worst = Math.max(worst, Math.abs(point.distanceTo(viewer.view.robot.hand.position) - distances[i]));
      });
      return [times.length, worst];
    })()`);
    assert.ok(samples > 100);
    assert.ok(worst < 2e-5, `${worst} m`);
  });
});

test('the gap between the closest pair is as long as the clearance at every sample', async () => {
  await opened('plan.html', {}, async page => {
    await scene(page);
    const [gaps, worst, label] = await page.evaluate(`(() => {
      const {viewer} = document.querySelector('article');
      const {gap} = viewer.view;
      const {times, clearances, nearest} = viewer.motion.approach;
      let worst = 0;
      times.forEach((time, i) => {
        if (!nearest[i]) return;
        viewer.seek(time);
        worst = Math.max(worst, Math.abs(gap.line.scale.y - clearances[i]),
            Math.abs(gap.ends[0].position.distanceTo(gap.ends[1].position) - clearances[i]));
      });
      viewer.seek(times[10]);
      viewer.view.draw();
      gap.follow(viewer.view.camera, 800, 500);
      return [nearest.filter(Boolean).length, worst,
        [gap.label.hidden, gap.label.textContent, clearances[10].toFixed(3) + ' m']];
    })()`);
    assert.ok(gaps > 100);
    assert.ok(worst < 2e-5, `${worst} m`);
    assert.equal(label[0], false);
    assert.equal(label[1], label[2]);
    const shown = time => page.evaluate(`(() => {
      const {viewer} = document.querySelector('article');
      viewer.seek(${time});
      return viewer.view.gap.group.visible;
    })()`);
    assert.equal(await shown(-5), true);
    assert.equal(await shown(2), false);
  });
});

/// A sphere of radius 1 with 4 n^2 - 4 n triangles, as OBJ.
function ball(n) {
  const lines = [];
  for (let i = 0; i <= n; ++i) {
    for (let k = 0; k < 2 * n; ++k) {
      const polar = Math.PI * i / n;
      const azimuth = Math.PI * k / n;
      lines.push(`v ${Math.sin(polar) * Math.cos(azimuth)} ${Math.sin(polar) * Math.sin(azimuth)} ${
          Math.cos(polar)}`);
    }
  }
  for (let i = 0; i < n; ++i) {
    for (let k = 0; k < 2 * n; ++k) {
      const [a, b] = [i * 2 * n + k + 1, i * 2 * n + (k + 1) % (2 * n) + 1];
      if (i > 0) lines.push(`f ${a} ${a + 2 * n} ${b}`);
      if (i + 1 < n) lines.push(`f ${b} ${a + 2 * n} ${b + 2 * n}`);
    }
  }
  return lines.join('\n') + '\n';
}

test('what a robot has for drawings is drawn where its files are, and thinned', async () => {
  cpSync(join(source, 'problems/planar_two_link_c2_a.yaml'), path('drawn/problem.yaml'));
  cpSync(join(source, 'problems/targets'), path('drawn/targets'), {recursive: true});
  const robot = readFileSync(join(source, 'problems/robots/planar_two_link_a.urdf'), 'utf8');
  const visual = (geometry, color) => `<visual><geometry>${
      geometry}</geometry><material name="m"><color rgba="${color} 1"/></material></visual>`;
  const ballInside = visual('<mesh filename="../meshes/ball.obj" scale="0.5 0.5 -0.2"/>', '1 0 0');
  const boxInside = visual('<box size="1 0.1 0.2"/>', '0 0 1') +
      visual('<mesh filename="../meshes/none.stl"/>', '0 1 0');
  const drawn = robot.replace('<link name="link_1">', '$&' + ballInside)
                    .replace('<link name="link_2">', '$&' + boxInside);
  assert.ok(drawn.split('<visual>').length === 4);
  mkdirSync(path('drawn/robots'));
  mkdirSync(path('drawn/meshes'));
  writeFileSync(path('drawn/robots/planar_two_link_a.urdf'), drawn);
  writeFileSync(path('drawn/meshes/ball.obj'), ball(120));
  run('plan', 'drawn/problem.yaml', '-o', 'drawn.json');
  run('report', 'drawn.json', '-o', 'drawn.html');
  run('check', 'drawn/problem.yaml', 'drawn/robots/planar_two_link_a.urdf', '-o', 'seen.html');
  // Elsewhere there is the plan alone.
  mkdirSync(path('elsewhere'));
  renameSync(path('drawn'), path('elsewhere/hidden'));
  run('report', 'drawn.json', '-o', 'plain.html');
  const look = page => page.evaluate(`(() => {
    const {view} = document.querySelector('article').viewer;
    const {joint, tool, centroid} = view.materials;
    return [0, 1].map(body => view.robot.body(body).children
      .filter(each => each.isMesh && ![joint, tool, centroid].includes(each.material))
      .map(mesh => ({
        type: mesh.geometry.type, color: mesh.material.color.getHexString(),
        corners: mesh.geometry.attributes.position.count, scale: mesh.scale.toArray(),
        radius: (mesh.geometry.computeBoundingSphere(), mesh.geometry.boundingSphere.radius)})));
  })()`);
  for (const name of ['drawn.html', 'seen.html']) {
    assert.ok(statSync(path(name)).size < 2e6);
    await opened(name, {}, async page => {
      await scene(page);
      const [[ball, ...others], [box]] = await look(page);
      assert.deepEqual(others, []);
      assert.ok(ball.corners / 3 <= 10000 && ball.corners / 3 > 2500, `${ball.corners}`);
      assert.ok(Math.abs(ball.radius - 1) < 0.05, `${ball.radius}`);
      assert.deepEqual(ball.scale, [0.5, 0.5, -0.2]);
      assert.equal(ball.color, 'ff0000');
      assert.equal(box.type, 'BoxGeometry');
      assert.equal(box.color, '0000ff');
    });
  }
  await opened('plain.html', {}, async page => {
    await scene(page);
    const [[capsule]] = await look(page);
    assert.equal(capsule.type, 'CapsuleGeometry');
  });
});

test('plots of joints say which one comes closest to its limit', async () => {
  await opened('plan.html', {}, async page => {
    const [robot, parts] = await page.evaluate(`(() => {
      const {motion, data} = document.querySelector('article').viewer;
      return [data.robot, [motion.approach, motion.after[0]]];
    })()`);
    const words = await text(page);
    for (const [column, limit, unit, factor] of [
             ['rates', 'max_velocity', 'deg/s', 180 / Math.PI],
             ['torques', 'max_effort', 'N m', 1]]) {
      let most = {part: 0};
      robot.joints.forEach((joint, k) => {
        const least = Math.max(...parts.flatMap(each => each[column]).map(row => Math.abs(row[k])));
        const part = least / joint[limit];
        if (part > most.part) most = {part, joint};
      });
      const shown =
          words.match(new RegExp(`closest to its limit: (\\S+), (\\S+) of (\\S+) ${unit}\n`));
      assert.equal(shown[1], most.joint.name);
      const [value, bound] = shown.slice(2).map(each => Number(each.replace('−', '-')));
      assert.ok(Math.abs(Math.abs(bound) / (factor * most.joint[limit]) - 1) < 0.01, shown[0]);
      assert.ok(Math.abs(value / bound / most.part - 1) < 0.02, shown[0]);
    }
  });
});

test('slider, keys and plots share the time', async () => {
  await opened('plan.html', {fragment: 't=-8'}, async page => {
    await scene(page);
    const clock = () => page.evaluate(`document.querySelector('.clock').textContent`);
    assert.equal(await clock(), '−8.00 s');
    await page.evaluate(
        `document.body.dispatchEvent(new KeyboardEvent('keydown', {key: 'c', bubbles: true}))`);
    assert.equal(await clock(), '+0.00 s');
    const impulse =
        await page.evaluate(`document.querySelector('article').viewer.view.impulse.visible`);
    assert.equal(impulse, true);
    await page.evaluate(
        `{ const slider = document.querySelector('.track input'); slider.value = 2; slider.dispatchEvent(new Event('input')); }`);
    assert.equal(await clock(), '+2.00 s');
    assert.match(
        await page.evaluate(`document.querySelector('.hud').innerText`), /after the impact/);
    assert.equal(
        await page.evaluate(
            `document.querySelector('article').viewer.slider.getAttribute('aria-label')`),
        'Time from the contact, s');
  });
});

test('a frame takes less than 33 ms of one processor with software rendering', async () => {
  await opened('plan.html', {}, async page => {
    await scene(page);
    await page.evaluate('new Promise(resolve => setTimeout(resolve, 500))');
    const frames = count => page.evaluate(`(() => {
      const {view, motion} = document.querySelector('article').viewer;
      const gl = view.renderer.getContext();
      for (let i = 0; i < ${count}; ++i) {
        view.show(motion.at(motion.begin + (motion.end - motion.begin) * i / ${count}, 0), null, 0);
        view.draw();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      }
    })()`);
    await frames(5);
    // Time of the browser's processes, ms.
    const spent = async () => {
      const {processInfo} = await browser.send('SystemInfo.getProcessInfo');
      return 1000 * processInfo.reduce((sum, each) => sum + each.cpuTime, 0);
    };
    const begin = await spent();
    await frames(60);
    const each = (await spent() - begin) / 60;
    assert.ok(each < 33, `${each} ms`);
  });
});

test('plots and words appear where WebGL does not', async () => {
  const plain = await Chromium.start({webgl: false});
  try {
    await opened('plan.html', {}, async page => {
      await page.evaluate(`document.querySelector('.viewer').scrollIntoView()`);
      await page.evaluate('new Promise(resolve => setTimeout(resolve, 300))');
      assert.match(await text(page), /WebGL 2 is missing/);
      assert.ok(await page.evaluate(`document.querySelectorAll('.plot canvas').length`) > 0);
    }, plain);
  } finally {
    await plain.close();
  }
});

test('hostile names in files do nothing', async () => {
  const hostile =
      `</script><script>document.title='taken'</script><img src=x onerror="document.title='taken'"><!-- "'&`;
  const plan = json('plan.json');
  plan.problem.purpose = hostile;
  plan.candidates[0].collision = hostile;
  plan.candidates[0].collision_free = false;
  plan.approach.detail = hostile;
  plan.tool = {[hostile]: hostile};
  plan.inputs[0].path = hostile;
  const verdict = {...json('verdict.json'), verdict: 'fail'};
  verdict.claims[0] =
      {...verdict.claims[0], group: hostile, name: hostile, detail: hostile, pass: false};
  plan.verification = verdict;
  writeFileSync(path('hostile.json'), JSON.stringify(plan));
  run('report', 'hostile.json', '-o', 'hostile.html');
  await opened('hostile.html', {}, async page => {
    await scene(page);
    assert.equal(await page.evaluate('document.title'), 'iiwa_client_50 – stillbase');
    assert.equal(await page.evaluate(`document.querySelectorAll('img').length`), 0);
    assert.ok((await text(page)).includes(hostile));
    assert.match(await text(page), /its fingerprint does not fit/);
  });
});

test('failed checks stand on top and are named, and a failed approach looks failed', async () => {
  const plan = json('plan.json');
  plan.approach = {...plan.approach, status: 'time_out', detail: 'no path in 60 s'};
  const verdict = json('verdict.json');
  verdict.verdict = 'fail';
  // Whatever else is not checked or fails: these two are.
  for (const claim of verdict.claims) claim.pass = true;
  Object.assign(verdict.claims[40], {pass: false, name: 'a_check_that_fails'});
  Object.assign(verdict.claims[41], {pass: null, detail: 'not enough samples'});
  plan.verification = verdict;
  writeFileSync(path('failed.json'), JSON.stringify(plan));
  run('report', 'failed.json', '-o', 'failed.html');
  await opened('failed.html', {}, async page => {
    const words = await text(page);
    assert.match(words, /No approach path: time out/);
    assert.match(
        words, /Verification failed: 1 of \d+ checks, 1 could not be made \(a check that fails\)/);
    assert.ok(
        await page.evaluate(`document.querySelector('article').classList.contains('failed')`));
    const section = words.slice(words.lastIndexOf('Verification failed'));
    assert.ok(section.indexOf('a check that fails') < section.indexOf('Could not be made'));
  });
});

test('several plans stand side by side', async () => {
  run('plan', join(source, 'problems/planar_two_link_c2_a.yaml'), '-o', 'planar.json');
  run('report', 'plan.json', 'planar.json', 'verdict.json', '-o', 'both.html');
  await opened('both.html', {}, async page => {
    const words = await text(page);
    assert.match(words, /Side by side/);
    assert.match(words, /Not verified/);
    await page.evaluate(`document.querySelectorAll('.tabs button')[1].click()`);
    await scene(page);
    assert.equal(
        await page.evaluate(`document.querySelector('h1').textContent`), 'planar_two_link_c2_a');
    // The damped arm brakes while the target goes on: the jump says nothing of the next contact.
    assert.match(await text(page), /Hand and target close once more .* m\/s with rns damped/);
  });
});

test('a sweep, a front and a verification alone have pages of their own', async () => {
  run('analyze', join(source, 'problems/planar_two_link_sweep_a.yaml'), '--sweep-direction', '72',
      '-o', 'sweep.json');
  run('plan', join(source, 'problems/planar_three_link_client.yaml'), '--pareto',
      'base_angular_momentum,joint_rate_norm', '-o', 'front.json');
  for (const [name, title, plots] of [
           ['sweep', 'Impact over its direction', 2], ['front', 'Front of two quantities', 1],
           ['verdict', 'Verification', 0]]) {
    run('report', `${name}.json`, '-o', `${name}.html`);
    await opened(`${name}.html`, {width: 1200}, async page => {
      assert.match(await text(page), new RegExp(title, 'i'));
      assert.equal(await page.evaluate(`document.querySelectorAll('.plot').length`), plots);
    });
  }
});

test('a cone as wide as the problem states costs what the plan says', async () => {
  await opened('plan.html', {}, async page => {
    const {deviations, chosen, nominal} =
        await page.evaluate(`document.querySelector('article').viewer.data.spreads`);
    const plan = json('plan.json');
    const at = deviations.findIndex(
        each => Math.abs(each - plan.problem.uncertainty.cone_half_angle) < 1e-9);
    const near = (value, wanted) =>
        assert.ok(Math.abs(value - wanted) < 0.01 * wanted, `${value} ${wanted}`);
    near(chosen[at], plan.objective.worst_case);
    near(nominal[at], plan.objective.nominal_optimum.worst_case);
    assert.ok(Math.abs(chosen[0] - plan.objective.nominal) < 1e-6);
    assert.match(await text(page), /What uncertainty of the direction costs/);
  });
});

test('check draws robots and problems, and its sliders move the joints', async () => {
  run('check', join(source, 'problems/iiwa_client_50.yaml'),
      join(source, 'problems/robots/deos.urdf'), '-o', 'check.html');
  await opened('check.html', {width: 1200}, async page => {
    await scene(page);
    assert.equal(await page.evaluate(`document.querySelectorAll('.joint').length`), 7);
    assert.match(
        await page.evaluate(`document.querySelector('.hud').innerText`), /window of contact times/);
    const hand = `document.querySelector('article').viewer.view.robot.hand.position.toArray()`;
    const before = await page.evaluate(hand);
    await page.evaluate(
        `{ const slider = document.querySelector('.joint input'); slider.value = 0; slider.dispatchEvent(new Event('input')); }`);
    assert.notDeepEqual(await page.evaluate(hand), before);
    await page.evaluate(`document.querySelectorAll('.tabs button')[1].click()`);
    await scene(page);
    assert.match(await text(page), /bodies after merging fixed links/);
  });
});

test('the committed page is what its sources give', async t => {
  const copy = path('web');
  cpSync(
      join(source, 'web'), copy, {recursive: true, filter: file => !file.includes('node_modules')});
  try {
    // A registry that does not answer is no fault of the page.
    execFileSync(
        'npm',
        [
          'ci', '--ignore-scripts', '--no-audit', '--no-fund', '--fetch-retries=0',
          '--fetch-timeout=20000'
        ],
        {cwd: copy, stdio: 'pipe', timeout: 60_000});
  } catch (error) {
    return t.skip(`npm ci: ${error.code ?? ''} ${error.stderr}`);
  }
  execFileSync('node', ['build.mjs', '--check'], {cwd: copy, stdio: 'pipe', timeout: 60_000});
});
