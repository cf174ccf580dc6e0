// The page of a plan: words first, then scene and plots, then what the words rest on.
import {degrees, digits, fixed, h, section, spaced, table} from './dom.js';
import {poseFrom} from './kinematics.js';
import {Motion} from './motion.js';
import {Plot, plotGrid} from './plots.js';
import {verdictOf, verificationParts} from './verification.js';
import {buttons, Viewer} from './viewer.js';

const kStatusWords = {
  optimal: 'Optimal configuration',
  feasible: 'Feasible configuration, not shown to be a local optimum',
  limit: 'Best configuration before a limit was reached',
  infeasible: 'No configuration satisfies the constraints',
};

/// Topics of the summary by what they answer.
const kQuestions = [
  ['What was decided', ['found', 'posture', 'base', 'contact', 'impulse']],
  ['How good it is', ['momentum', 'case', 'approach']],
  ['How sure it is', ['search', 'certificate', 'coverage', 'curves', 'proof', 'solvers']],
];

/// The index of the chosen candidate; -1: none is it.
export function chosenIndex(plan) {
  const {joint_positions: wanted, contact_time: time} = plan.configuration;
  return plan.candidates.findIndex(
      candidate => Math.abs(candidate.contact_time - time) < 1e-9 &&
          candidate.joint_positions.every((x, k) => Math.abs(x - wanted[k]) < 1e-9));
}

export const approachFails = plan => !['found', 'not_requested'].includes(plan.approach.status);

/// Tone and words of what is known of a plan, most important first.
export function standing(document) {
  const {content: plan, verification} = document;
  const out = [];
  if (plan.status === 'infeasible')
    out.push(['fail', kStatusWords.infeasible]);
  else if (approachFails(plan))
    out.push(['fail', `No approach path: ${spaced(plan.approach.status)}`]);
  else if (plan.status === 'limit')
    out.push(['warn', kStatusWords.limit]);
  if (document.as_written === false)
    out.push(['fail', 'The file was changed after it was written: its fingerprint does not fit']);
  out.push(verdictOf(verification));
  return out;
}

/// The rows of a plan's comparison with others.
export function figures(document) {
  const {content: plan, scene} = document;
  const {objective, approach, impact} = plan;
  const rate = degrees(Math.hypot(...impact.base_velocity_jump.angular));
  const cone = scene.cone_half_angle;
  return [
    [spaced(objective.name) + ', nominal', objective.nominal, objective.unit],
    cone > 0 ? ['worst case over the cone', objective.worst_case, objective.unit] : null,
    cone > 0 ? ['half-angle of the cone', degrees(cone), 'deg'] : null,
    ['base rate after the impact', rate, 'deg/s'],
    ['impulse', Math.hypot(...impact.impulse.force), 'N s'],
    approach.status === 'found' && approach.min_clearance !== null ?
        ['clearance of the approach', approach.min_clearance, 'm'] :
        null,
    approach.status === 'found' ? ['motion', approach.duration, 's'] : null,
  ].filter(row => row !== null);
}

function constraintUnit(name, plan) {
  if (name.startsWith('clearance') || name.startsWith('hand_position')) return 'm';
  if (name.startsWith('closing_speed')) return 'm/s';
  if (name.startsWith('joint_limit')) {
    const joint = plan.sceneRobot.joints.find(each => name === `joint_limit_${each.name}`);
    return joint?.slides ? 'm' : 'rad';
  }
  if (name.startsWith('joint_rate')) return 'rad/s';
  return '1';
}

/// Distance to the nearer bound; negative: violated.
const marginOf = row =>
    Math.min(row.value - (row.lower ?? -Infinity), (row.upper ?? Infinity) - row.value);

function binding(document) {
  const {content: plan} = document;
  plan.sceneRobot = document.scene.robot;
  const inequalities = plan.constraints.filter(row => row.lower !== row.upper);
  const atBound = inequalities.filter(row => marginOf(row) < 1e-6);
  const next = inequalities.filter(row => marginOf(row) >= 1e-6)
                   .sort((a, b) => marginOf(a) - marginOf(b))
                   .slice(0, 5);
  const row = each =>
      [spaced(each.name), each.value, each.lower === null ? 'none' : each.lower,
       each.upper === null ? 'none' : each.upper, marginOf(each), constraintUnit(each.name, plan)];
  const words = atBound.length ?
      `At their bounds: ${
          atBound.map(each => spaced(each.name))
              .join(', ')}. Relaxing one of these could improve the plan.` :
      'No inequality is at its bound.';
  const list = document.content.binding;
  return section(
      'What binds', h('p', {}, words),
      Array.isArray(list) && list.length ? table(
                                               ['limit', 'margin', 'multiplier', 'unit'],
                                               list.map(
                                                   each =>
                                                       [spaced(each.name ?? each.limit ?? ''),
                                                        each.margin, each.multiplier, each.unit])) :
                                           null,
      table(
          ['constraint', 'value', 'lower', 'upper', 'margin', 'unit'],
          [...atBound, ...next].map(row), {rowClass: i => i < atBound.length ? 'binds' : null}),
      h('details', {}, h('summary', {}, `All ${plan.constraints.length} constraints`),
        table(
            ['constraint', 'value', 'lower', 'upper', 'violation', 'unit'],
            plan.constraints.map(
                each =>
                    [spaced(each.name), each.value, each.lower ?? 'none', each.upper ?? 'none',
                     each.violation, constraintUnit(each.name, plan)]),
            {rowClass: i => plan.constraints[i].violation > 1e-6 ? 'fails' : null})));
}

function risks(document) {
  const {content: plan, scene, verification} = document;
  const out = [];
  const {objective, approach} = plan;
  if (plan.status === 'infeasible') {
    for (const row of plan.constraints.filter(each => each.violation > 1e-9)
             .sort((a, b) => b.violation - a.violation)) {
      out.push(`${spaced(row.name)} = ${digits(row.value)} violates its bounds by ${
          digits(
              row.violation, 3)} ${constraintUnit(row.name, {...plan, sceneRobot: scene.robot})}.`);
    }
  }
  if (approachFails(plan)) out.push(`Approach: ${spaced(approach.status)}. ${approach.detail}`);
  if (scene.cone_half_angle > 0 && objective.worst_case > 1.05 * objective.nominal) {
    const times = objective.nominal > 1e-9 ?
        `, ${digits(objective.worst_case / objective.nominal, 3)} times the nominal value` :
        '';
    out.push(`An impulse ${
        digits(degrees(scene.cone_half_angle))} deg off its nominal direction leaves up to ${
        digits(objective.worst_case, 3)} ${objective.unit}${times}.`);
  }
  if (scene.cone_half_angle === 0)
    out.push(
        'No uncertainty of the direction is stated: the value holds for the exact nominal direction alone.');
  if (approach.status === 'found' && approach.min_clearance !== null) {
    out.push(`The approach passes ${
        fixed(
            approach.min_clearance,
            3)} m from a body that may not be touched (hand and target left out).`);
  }
  for (const record of scene.after ?? []) {
    const rate = degrees(Math.hypot(...record.base_rates.at(-1).slice(3)));
    if (rate > 0.1)
      out.push(`Under ${spaced(record.controller)} the base still rotates at ${
          digits(rate, 3)} deg/s after ${digits(record.times.at(-1))} s.`);
  }
  const open = (verification?.claims ?? []).filter(claim => claim.pass === null);
  if (open.length) out.push(`${open.length} verification checks could not be made.`);
  if (!verification)
    out.push(
        'Nothing was verified by other code: run `stillbase verify` and give its file to `report` as well.');
  return section(
      'What could go wrong', h('ul', {class: 'risks'}, out.map(text => h('li', {}, text))));
}

/// What other directions of the impulse do to the chosen posture and to the nominal optimum.
function spreads(document) {
  const {spreads: data, cone_half_angle: cone} = document.scene;
  if (!data) return null;
  const series = [{name: 'chosen posture', color: '--series-0', y: data.chosen}];
  if (data.nominal) {
    series.push(
        {name: 'optimum for the nominal direction alone', color: '--series-1', y: data.nominal});
  }
  const plot = new Plot({
    title:
        'Most angular momentum into the base, over the deviation of the impulse from its nominal direction',
    x_label: 'deviation, deg',
    y_label: 'N m s',
    x: data.deviations.map(degrees),
    x_name: 'deg',
    height: 260,
    from_zero: true,
    series,
    marks: [{x: degrees(cone), label: 'cone'}],
  });
  return section(
      'What uncertainty of the direction costs', h('div', {class: 'plots one'}, plot.element));
}

function candidateTable(document) {
  const {content: plan} = document;
  if (!plan.candidates.length) return null;
  const chosen = chosenIndex(plan);
  const {unit} = plan.objective;
  const reason = (candidate, i) => {
    if (i === chosen) return 'chosen';
    if (candidate.excluded)
      return typeof candidate.excluded === 'string' ? candidate.excluded :
                                                      JSON.stringify(candidate.excluded);
    if (!candidate.collision_free) return `collides: ${candidate.collision || 'bodies touch'}`;
    if (i < chosen) return 'no approach path to it, or the motion after the impact exceeds a limit';
    return '';
  };
  const better = chosen > 0 ? chosen : 0;
  const words = chosen < 0 ? 'None of the candidates was chosen.' :
      better ? `${better} candidate${better > 1 ? 's rank' : ' ranks'} before the chosen one and ${
                   better > 1 ? 'were' : 'was'} excluded.` :
               'No candidate ranks before the chosen one.';
  const row = (candidate, i) =>
      [i + 1, candidate.objective, candidate.worst_case, candidate.value,
       fixed(candidate.contact_time, 3),
       candidate.joint_positions
           .map(
               (x, k) => document.scene.robot.joints[k].slides ? `${fixed(x, 3)} m` :
                                                                 `${fixed(degrees(x), 1)}°`)
           .join(', '),
       reason(candidate, i)];
  const header = [
    'rank', `nominal, ${unit}`, `worst case, ${unit}`, `measure, ${unit}`, 'contact, s',
    'joints, deg (m)', 'remark'
  ];
  const options = {
    label: 'Candidates',
    rowClass: i => i === chosen ? 'chosen' :
        i < chosen              ? 'excluded' :
                                  null
  };
  const shown = Math.min(plan.candidates.length, Math.max(better + 1, 5));
  return section(
      'Better candidates, and why they were excluded', h('p', {}, words),
      table(header, plan.candidates.slice(0, shown).map(row), options),
      shown < plan.candidates.length ?
          h('details', {}, h('summary', {}, `All ${plan.candidates.length} candidates`),
            table(header, plan.candidates.map(row), options)) :
          null);
}

function inputs(document) {
  const {content: plan} = document;
  const rows = (plan.inputs ?? []).map(input => [input.role, input.path, input.sha256]);
  rows.push(['robot as read', document.scene.robot.name, plan.robot.sha256]);
  rows.push(['content of the plan', document.path, plan.content_sha256]);
  return section(
      'Inputs', table(['role', 'path', 'SHA-256'], rows, {class: 'hashes'}),
      h('p', {class: 'quiet'},
        Object.entries(plan.tool).map(([name, version]) => `${name} ${version}`).join(', ') +
            `. Optimizer ${plan.optimizer}. ` +
            Object.entries(plan.timing ?? {})
                .map(([name, seconds]) => `${name} ${digits(seconds, 3)} s`)
                .join(', ') +
            '.'));
}

/// The plots over time, from the approach on through the motion under one controller.
class TimePlots {
  constructor(motion, robot, onSeek) {
    this.motion = motion;
    this.robot = robot;
    this.onSeek = onSeek;
    this.grid = h('div', {class: 'plots'});
    this.span = null;
    this.element =
        h('section', {}, motion.approach && motion.after.length ? this.spanButtons() : null,
          this.grid);
    this.show(0);
  }

  /// Which part of the time the plots show.
  spanButtons() {
    const {begin, end} = this.motion;
    return h(
        'div', {class: 'spans'},
        buttons(
            'Time shown in the plots',
            {all: 'All', approach: 'Approach', after: 'After the impact', first: 'First second'},
            'all', key => {
              this.span = {
                all: null,
                approach: [begin, 0],
                after: [0, end],
                first: [-0.1, Math.min(1, end)]
              }[key];
              for (const plot of this.plots) plot.setSpan(this.span);
            }));
  }

  show(controller) {
    const parts = [this.motion.approach, this.motion.after[controller]].filter(Boolean);
    const columns = name => parts.flatMap(part => part[name] ?? []);
    const x = columns('times');
    if (x.length < 2) return;
    const marks =
        this.motion.approach && this.motion.after.length ? [{x: 0, label: 'contact'}] : [];
    const plot = (title, y_label, series, more = {}) => new Plot({
      title,
      x_label: 'time from the contact, s',
      y_label,
      x,
      series,
      marks,
      onSeek: this.onSeek,
      ...more,
    });
    const norm = list => Math.hypot(...list);
    const base = columns('base').map(poseFrom);
    const reference = base[Math.max(0, (this.motion.approach?.times.length ?? 1) - 1)].quaternion;
    const rates = columns('base_rates');
    const momenta = columns('momenta');
    const {joints} = this.robot;
    const plots = [
      plot(
          'Base: rotation away from the attitude at the contact', 'deg', [{
            name: 'rotation angle',
            y: base.map(pose => degrees(pose.quaternion.angleTo(reference)))
          }],
          {from_zero: true}),
      plot(
          'Base: angular rate', 'deg/s',
          [
            {name: '|ω|', y: rates.map(rate => degrees(norm(rate.slice(3))))},
            ...['x', 'y', 'z'].map(
                (axis, k) =>
                    ({name: `ω ${axis}`, y: rates.map(rate => degrees(rate[3 + k])), width: 1}))
          ]),
      plot(
          'Angular momentum about the centroid, norms', 'N m s',
          [['base part', '--series-1'], ['coupling part', '--series-0'], ['total', '--ink']].map(
              ([name, color], k) => ({name, color, y: momenta.map(row => row[k])})),
          {from_zero: true}),
    ];
    const count = columns('distances').length;
    if (count === x.length) {
      plots.push(
          plot(
              'Hand to contact feature', 'm', [{name: 'distance', y: columns('distances')}],
              {from_zero: true}),
          plot(
              'Closing speed along the normal', 'm/s',
              [{name: 'closing speed', y: columns('closing_speeds')}]));
    }
    for (const slides of [false, true]) {
      const of = joints.map((joint, k) => [joint, k]).filter(([joint]) => joint.slides === slides);
      if (!of.length) continue;
      const scale = slides ? 1 : 180 / Math.PI;
      const unit = slides ? 'm' : 'deg';
      const series = (name, factor) => of.map(
          ([joint, k]) => ({name: joint.name, y: columns(name).map(row => factor * row[k])}));
      const limits = (low, high, factor) =>
          of.flatMap(([joint]) => [joint[low], joint[high]])
              .filter(limit => limit !== null && limit !== undefined)
              .flatMap(limit => low === high ? [factor * limit, -factor * limit] : [factor * limit])
              .map(y => ({y}));
      plots.push(
          plot(
              slides ? 'Sliding joints: positions' : 'Joint positions', unit,
              series('joints', scale), {limits: limits('lower', 'upper', scale)}),
          plot(
              slides ? 'Sliding joints: rates' : 'Joint rates', `${unit}/s`, series('rates', scale),
              {limits: limits('max_velocity', 'max_velocity', scale)}),
          plot(
              slides ? 'Sliding joints: forces' : 'Joint torques', slides ? 'N' : 'N m',
              series('torques', 1).map(each => ({...each, steps: true})),
              {limits: limits('max_effort', 'max_effort', 1)}));
    }
    const rns = columns('rns');
    const all = columns('rates');
    plots.push(plot(
        'Joint rates: parts by the reaction null space, norms',
        joints.some(joint => joint.slides) ? 'rad/s (m/s)' : 'rad/s',
        [
          {name: 'joint rates', color: '--ink', y: all.map(norm)},
          {name: 'in the null space', color: '--series-0', y: rns.map(norm)}, {
            name: 'orthogonal',
            color: '--series-1',
            y: all.map((row, i) => norm(row.map((rate, k) => rate - rns[i][k])))
          }
        ],
        {from_zero: true}));
    if (this.motion.approach?.clearances?.some(each => each !== null)) {
      const {times, clearances} = this.motion.approach;
      plots.push(new Plot({
        title: 'Clearance of the approach, hand and target left out',
        x_label: 'time from the contact, s',
        y_label: 'm',
        x: times,
        series: [{name: 'closest pair', y: clearances}],
        onSeek: this.onSeek,
        from_zero: true
      }));
    }
    this.plots = plots;
    this.grid.replaceChildren(...plots.map(each => each.element));
    for (const each of plots) each.setSpan(this.span);
    if (this.time !== undefined) this.setTime(this.time);
  }

  setTime(time) {
    this.time = time;
    for (const plot of this.plots ?? []) plot.setTime(time);
  }
}

function tiles(document) {
  const checks = document.verification?.claims;
  const rows = figures(document).map(([label, value, unit]) => [label, digits(value, 3), unit]);
  if (checks)
    rows.push([
      'verification checks hold',
      `${checks.filter(claim => claim.pass === true).length} of ${checks.length}`, ''
    ]);
  return h(
      'dl', {class: 'tiles'},
      rows.map(
          ([label, value, unit]) =>
              h('div', {}, h('dt', {}, label),
                h('dd', {}, value, h('small', {}, unit ? ` ${unit}` : '')))));
}

/// @return {element, connect(theme), paint(theme), key(event)}
export function planPage(document) {
  const {content: plan, scene, summary} = document;
  const words = topics => {
    const lines = [];
    let topic = '';
    for (const line of summary) {
      if (line.topic) topic = line.topic;
      if (topics.includes(topic))
        lines.push(
            h('p', {}, line.topic ? h('b', {}, line.topic) : null, line.topic ? ' ' : '',
              line.words));
    }
    return lines;
  };
  const motion = new Motion(scene);
  const plots = new TimePlots(motion, scene.robot, time => viewer.seek(time));
  const candidates = plan.candidates.map(
      (candidate, i) => ({
        label: `${i + 1}: ${digits(candidate.value, 3)} ${plan.objective.unit}${
            candidate.collision_free ? '' : ', collides'}`,
        words: candidate.collision_free ? `contact at ${fixed(candidate.contact_time, 3)} s` :
                                          `collides: ${candidate.collision}`,
        joints: candidate.joint_positions,
        base: [
          ...candidate.base_pose.position,
          ...['w', 'x', 'y', 'z'].map(axis => candidate.base_pose.orientation[axis])
        ],
        target: scene.candidate_targets?.[i] ?? null,
      }));
  const viewer = new Viewer(
      scene, motion,
      {candidates, onTime: time => plots.setTime(time), onController: index => plots.show(index)});
  const head =
      h('header', {class: 'document-head'}, h('p', {class: 'kicker'}, 'Capture plan'),
        h('h1', {}, plan.problem.name), h('p', {class: 'purpose'}, plan.problem.purpose),
        h('ul', {class: 'standing'},
          standing(document).map(([tone, text]) => h('li', {class: tone}, text))));
  const element =
      h('article', {class: plan.status === 'infeasible' || approachFails(plan) ? 'failed' : null},
        head, tiles(document),
        h('div', {class: 'answers'},
          kQuestions.map(([title, topics]) => section(title, words(topics)))),
        h('section', {class: 'wide'}, h('h2', {}, 'The capture'), viewer.element), plots.element,
        risks(document), spreads(document), binding(document), candidateTable(document),
        verificationParts(document.verification), inputs(document));
  element.viewer = viewer;
  return {
    element,
    connect: theme => viewer.connect(theme),
    paint: theme => viewer.paint(theme),
    key: event => viewer.key(event),
    viewer
  };
}
