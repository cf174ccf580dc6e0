// The sections of a plan's page that say what its words rest on.
import {degrees, digits, fixed, h, section, spaced, table} from './dom.js';
import {Plot} from './plots.js';
import {approachFails, controllerName} from './standing.js';

/// The index of the chosen candidate; -1: none is it.
function chosenIndex(plan) {
  const {joint_positions: wanted, contact_time: time} = plan.configuration;
  return plan.candidates.findIndex(
      candidate => Math.abs(candidate.contact_time - time) < 1e-9 &&
          candidate.joint_positions.every((x, k) => Math.abs(x - wanted[k]) < 1e-9));
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

export function binding(document) {
  const {content: plan} = document;
  const list = plan.binding;
  plan.sceneRobot = document.scene.robot;
  const inequalities = plan.constraints.filter(row => row.lower !== row.upper);
  const atBound = inequalities.filter(row => marginOf(row) < 1e-6);
  const next = inequalities.filter(row => marginOf(row) >= 1e-6)
                   .sort((a, b) => marginOf(a) - marginOf(b))
                   .slice(0, 5);
  const row = each =>
      [spaced(each.name), each.value, each.lower, each.upper, marginOf(each),
       constraintUnit(each.name, plan)];
  const words = atBound.length ?
      `At their bounds: ${
          atBound.map(each => spaced(each.name))
              .join(', ')}. Relaxing one of these could improve the plan.` :
      list?.length ? 'No constraint is at its bound, but a limit of the search is.' :
                     'No inequality is at its bound.';
  return section(
      'What binds', h('p', {}, words),
      list?.length ?
          table(
              ['decides the value', 'end', 'at', 'unit', `saves, ${plan.objective.unit} per unit`],
              list.map(
                  each => [spaced(each.name), each.end, each.limit, each.unit, each.multiplier])) :
          null,
      table(
          ['constraint', 'value', 'lower', 'upper', 'margin', 'unit'],
          [...atBound, ...next].map(row), {rowClass: i => i < atBound.length ? 'binds' : null}),
      h('details', {}, h('summary', {}, `All ${plan.constraints.length} constraints`),
        table(
            ['constraint', 'value', 'lower', 'upper', 'violation', 'unit'],
            plan.constraints.map(
                each =>
                    [spaced(each.name), each.value, each.lower, each.upper, each.violation,
                     constraintUnit(each.name, plan)]),
            {rowClass: i => plan.constraints[i].violation > 1e-6 ? 'fails' : null})));
}

/// Rounding of what just keeps a limit counts as keeping it.
const exceeds = use => use.value > use.most * (1 + 1e-6);

/// What has to go somewhere after the contact, and how much of each limit that takes.
export function grasp(document) {
  const managed = document.content.managed_momentum;
  if (!managed) return null;
  const [angular, linear] = [managed.angular, managed.linear].map(each => Math.hypot(...each));
  const time = managed.least_time === null ?
      '' :
      ` The wheels need at least ${digits(managed.least_time)} s for it.`;
  return section(
      'After the contact',
      h('p', {},
        `${digits(angular, 3)} N m s and ${digits(linear, 3)} N s have to be managed.${time}`),
      table(
          ['limit', 'of', 'value', 'allowed', 'used', 'unit'],
          managed.limits.map(
              use =>
                  [spaced(use.limit), spaced(use.place), use.value, use.most,
                   use.most > 0 ? `${fixed(100 * use.value / use.most, 1)} %` : null, use.unit]),
          {rowClass: i => exceeds(managed.limits[i]) ? 'fails' : null}));
}

export function risks(document) {
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
  out.push(...(plan.warnings ?? []).map(each => each.message));
  if (scene.cone_half_angle === 0 && !objective.residual)
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
      out.push(`With ${controllerName(record.controller)} the base still rotates at ${
          digits(rate, 3)} deg/s after ${digits(record.times.at(-1))} s.`);
  }
  const {after_horizon: later, problem} = plan;
  if (later?.moves) {
    const horizon = digits(problem.post_impact.horizon);
    const fate = later.stop_time === null ?
        'none reaches a stop within ten horizons' :
        `${spaced(later.joint)} reaches its stop ${
            digits(later.stop_time)} s after the impact unless something is done`;
    out.push(`After the horizon of ${horizon} s joints still move: ${fate}.`);
  }
  // The instantaneous impact knows one contact: what closes afterwards would touch once more.
  const jumps = problem.post_impact?.contact?.model === 'instantaneous';
  const sticks = problem.impact?.contact === 'sticking';
  const closing = (jumps ? scene.after ?? [] : []).flatMap(record => {
    const soon = record.closing_speeds.filter((speed, i) => record.times[i] <= 2);
    const most = record.held ? 0 : Math.max(0, ...soon);
    return most > 0.05 * plan.impact.closing_speed ?
        [`${digits(most, 3)} m/s with ${controllerName(record.controller)}`] :
        [];
  });
  if (closing.length) {
    out.push(
        `Hand and target close once more within 2 s of the impact, at up to ${closing.join(', ')}${
            sticks ? '' : '; a compliant contact (post_impact.contact) simulates what follows'}.`);
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
export function spreads(document) {
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

/// The joint of a candidate whose angle is free, with the ends of its range; null: none. Its curve
/// states two points, of a whole turn three, that differ in this joint alone.
function freeRoll(plan, candidate) {
  const points = plan.families?.[candidate.family]?.points ?? [];
  if (points.length < 2 || points.length > 3) return null;
  const ends = [points[0].joint_positions, points.at(-1).joint_positions];
  const differing = ends[0].flatMap((x, k) => x === ends[1][k] ? [] : [k]);
  return differing.length === 1 ? {joint: differing[0], ends: ends.map(end => end[differing[0]])} :
                                  null;
}

export function candidateTable(document) {
  const {content: plan} = document;
  if (!plan.candidates.length) return null;
  const chosen = chosenIndex(plan);
  const {unit} = plan.objective;
  const reason = (candidate, i) => {
    if (i === chosen) return 'chosen';
    if (candidate.excluded)
      return typeof candidate.excluded === 'string' ? candidate.excluded :
                                                      JSON.stringify(candidate.excluded);
    if (candidate.collision === 'not judged') return candidate.collision;
    if (!candidate.collision_free) return `collides: ${candidate.collision || 'bodies touch'}`;
    if (i < chosen) return 'no approach path to it, or the motion after the impact exceeds a limit';
    return '';
  };
  const better = chosen > 0 ? chosen : 0;
  const words = chosen < 0 ? 'None of the candidates was chosen.' :
      better ? `${better} candidate${better > 1 ? 's rank' : ' ranks'} before the chosen one and ${
                   better > 1 ? 'were' : 'was'} excluded.` :
               'No candidate ranks before the chosen one.';
  const {joints} = document.scene.robot;
  const angle = x => `${fixed(degrees(x), 1)}°`;
  const posture = candidate => {
    const roll = freeRoll(plan, candidate);
    return candidate.joint_positions
        .map((x, k) => {
          if (joints[k].slides) return `${fixed(x, 3)} m`;
          if (k === roll?.joint) return `${angle(x)} (any from ${roll.ends.map(angle).join(' to ')})`;
          const turns = candidate.turns?.find(each => each.joint === joints[k].name);
          const others = turns ? [turns.least, turns.most].filter(turn => turn !== 0) : [];
          return others.length ?
              `${angle(x)} (or ${others.map(turn => angle(x + 2 * Math.PI * turn)).join(', ')})` :
              angle(x);
        })
        .join(', ');
  };
  const row = (candidate, i) =>
      [`${i + 1}`, candidate.objective, candidate.worst_case, candidate.value,
       fixed(candidate.contact_time, 3), posture(candidate), reason(candidate, i)];
  const header = [
    'rank', `nominal, ${unit}`, `worst case, ${unit}`, `measure, ${unit}`, 'contact, s',
    'joints, deg (m)', 'remark'
  ];
  const classOf = i => i === chosen ? 'chosen' : i < chosen ? 'excluded' : null;
  const shown = Math.min(plan.candidates.length, Math.max(better + 1, 5));
  // Candidates that differ in their joints alone stand in one row: points of a continuum.
  const groups = [];
  plan.candidates.slice(0, shown).forEach((candidate, i) => {
    const cells = row(candidate, i);
    const key = [
      ...cells.slice(1, 5).map(cell => typeof cell === 'number' ? digits(cell) : cell), cells[6]
    ].join();
    const last = groups.at(-1);
    if (last?.key === key && classOf(i) === classOf(last.first))
      last.count += 1;
    else
      groups.push({key, cells, first: i, count: 1});
  });
  const merged = groups.map(({cells, first, count}) => count === 1 ? cells : [
    `${first + 1}\u2060–\u2060${first + count}`, ...cells.slice(1, 5),
    `${cells[5]}; ${count - 1} more that differ in the joints alone`, cells[6]
  ]);
  return section(
      'Better candidates, and why they were excluded', h('p', {}, words),
      table(header, merged, {label: 'Candidates', rowClass: i => classOf(groups[i].first)}),
      h('details', {}, h('summary', {}, `All ${plan.candidates.length} candidates`),
        table(header, plan.candidates.map(row), {label: 'All candidates', rowClass: classOf})));
}

export function inputs(document) {
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
