// Pages of what is no plan: a sweep of directions, a front, a campaign, a benchmark.
import {degrees, digits, h, section, spaced, table} from './dom.js';
import {Plot, plotGrid} from './plots.js';
import {svg, trialParts} from './trials.js';

function head(kicker, title, purpose) {
  return h(
      'header', {class: 'document-head'}, h('p', {class: 'kicker'}, kicker), h('h1', {}, title),
      h('p', {class: 'purpose'}, purpose));
}

const norm = list => Math.hypot(...list);

/// The angle of a line in the xy plane, in [0, 180) deg.
function lineAngle([x, y]) {
  const angle = degrees(Math.atan2(y, x));
  return ((angle % 180) + 180) % 180;
}

/// Figs. 4 and 5 of the paper: momenta and joint rates over the direction of the impulse.
export function analysisPage({content, path}) {
  const {rows, posture, joint_resistances: resistances} = content;
  const along =
      Math.max(...rows.flatMap(row => Object.values(row.momentum).map(v => Math.abs(v[2]))));
  const across = Math.max(
      ...rows.flatMap(row => Object.values(row.momentum).map(v => Math.hypot(v[0], v[1]))));
  const planar = across <= 1e-9 * along;
  const closed = rows.length > 1 ? [...rows, {...rows[0], direction_deg: 360}] : rows;
  const x = closed.map(row => row.direction_deg);
  const plane = posture.zero_directions.in_xy_plane;
  const only =
      ['all', 'base', 'coupling', 'total'].filter(name => plane[name].directions.length === 1);
  const labels = {all: 'C2', base: 'G2', coupling: 'G3', total: 'C1'};
  const marks = (only.includes('all') ? ['all'] : only).flatMap(name => {
    const angle = lineAngle(plane[name].directions[0]);
    return [angle, angle + 180].map(at => ({x: at, label: labels[name]}));
  });
  const value = v => planar ? v[2] : norm(v);
  const x_label = 'direction of the impulse, deg';
  const plots = rows.length < 2 ? [] : [
    new Plot({
      title: `Change of angular momentum${planar ? ' about z' : ', norms'}`,
      x_label,
      y_label: 'N m s',
      x,
      marks,
      x_name: 'deg',
      height: 260,
      series: [['total', '--ink'], ['base', '--series-1'], ['coupling', '--series-0']].map(
          ([name, color]) => ({name, color, y: closed.map(row => value(row.momentum[name]))})),
    }),
    new Plot({
      title: 'Joint rates after the impact, norms',
      x_label,
      y_label: 'rad/s (m/s)',
      x,
      marks,
      x_name: 'deg',
      height: 260,
      from_zero: true,
      series: [
        ['joint rates', 'joint_velocity_jump', '--ink'],
        ['in the null space', 'joint_velocity_rns', '--series-0'],
        ['orthogonal', 'joint_velocity_orthogonal', '--series-1']
      ].map(([name, key, color]) => ({name, color, y: closed.map(row => norm(row[key]))})),
    }),
  ];
  const figures = entry =>
      [entry.case, norm(entry.impulse.force), norm(entry.momentum.total), norm(entry.momentum.base),
       norm(entry.momentum.coupling), degrees(norm(entry.base_velocity_jump.angular)),
       norm(entry.joint_velocity_jump)];
  const columns = [
    'case', 'impulse, N s', 'total, N m s', 'base, N m s', 'coupling, N m s', 'base rate, deg/s',
    'joint rates, rad/s (m/s)'
  ];
  const best = rows.reduce((a, b) => norm(a.momentum.base) <= norm(b.momentum.base) ? a : b);
  const worst = rows.reduce((a, b) => norm(a.momentum.base) >= norm(b.momentum.base) ? a : b);
  const words = rows.length > 1 ?
      `Of ${rows.length} directions ${
          digits(best.direction_deg)} deg leaves least momentum in the base, ${
          digits(norm(best.momentum.base), 3)} N m s; ` +
          `${digits(worst.direction_deg)} deg leaves most, ${
              digits(norm(worst.momentum.base), 3)} N m s.` :
      `The impulse along ${digits(best.direction_deg)} deg leaves ${
          digits(norm(best.momentum.base), 3)} N m s in the base.`;
  return {
    element:
        h('article', {}, head('Impact over its direction', content.problem ?? path, words),
          plotGrid(plots),
          section(
              'Joints that resist in different ways, in the stated direction',
              table(
                  ['joints', ...columns],
                  (resistances ?? [])
                      .map(
                          entry =>
                              [spaced(entry.joint_resistance) +
                                   (entry.illustrative ? ' (illustrative values)' : ''),
                               ...figures(entry)]))),
          section(
              'Directions',
              h('details', {}, h('summary', {}, `All ${rows.length}`),
                table(
                    ['direction, deg', ...columns],
                    rows.map(row => [row.direction_deg, ...figures(row)])))))
  };
}

/// Two quantities against each other: the points that were found, without a line across gaps.
export function paretoPage({content}) {
  const [first, second] = content.quantities;
  const points = [...content.points].sort((a, b) => a[first.name] - b[first.name]);
  const label = quantity => `${spaced(quantity.name)}, ${quantity.unit}`;
  const ends = [points[0], points.at(-1)];
  const words = points.length ?
      `Increasing ${spaced(first.name)} from ${digits(ends[0][first.name], 3)} to ${
          digits(ends[1][first.name], 3)} ${first.unit} reduces ` +
          `${spaced(second.name)} from ${digits(ends[0][second.name], 3)} to ${
              digits(ends[1][second.name], 3)} ${second.unit}.` :
      'No configuration satisfies the constraints.';
  const plot = new Plot({
    title: 'Points that were found',
    x_label: label(first),
    y_label: label(second),
    x: points.map(point => point[first.name]),
    height: 360,
    x_name: spaced(first.name),
    series: [{name: spaced(second.name), y: points.map(point => point[second.name]), points: true}]
  });
  const joints = points[0]?.joint_positions.length ?? 0;
  return {
    element:
        h('article', {class: points.length ? null : 'failed'},
          head('Front of two quantities', content.problem, words),
          content.complete === false ?
              h('p', {class: 'verdict warn'}, 'Stopped early: the front is incomplete') :
              null,
          points.length > 1 ? h('div', {class: 'plots one'}, plot.element) : null,
          section(
              'Points',
              table(
                  [
                    label(first), label(second), 'contact, s',
                    ...Array.from({length: joints}, (_, k) => `joint ${k + 1}, rad (m)`),
                    'largest violation'
                  ],
                  points.map(
                      point =>
                          [point[first.name], point[second.name], point.contact_time,
                           ...point.joint_positions, point.max_violation]))))
  };
}

export function campaignPage({content, path}) {
  const {groups} = content;
  const total = groups.reduce((sum, group) => sum + group.trials.count, 0);
  const good = groups.reduce((sum, group) => sum + group.trials.successes, 0);
  const failed = groups.filter(group => !group.verified || group.plan_status === 'infeasible');
  const words = `${total} trials of ${groups.length} ${
      groups.length === 1 ? 'plan' : 'plans and seeds'}; ${good} succeeded.`;
  const standing = [content.complete ? ['pass', 'Complete: every case once'] : [
    'fail', `Incomplete: ${content.missing.length} of ${content.case_count} cases missing`
  ]];
  if (content.contradictory.length)
    standing.push(['fail', `${content.contradictory.length} cases contradict each other`]);
  if (failed.length)
    standing.push(['fail', `${failed.length} plans failed or did not pass their verification`]);
  const name = group => `${(group.plan ?? group.problem).split('/').at(-1)}, seed ${group.seed}`;
  const rows = groups.map(group => {
    const {trials} = group;
    return [
      name(group), trials.count, trials.success_probability, trials.success_interval.lower,
      trials.success_interval.upper, spaced(group.plan_status), group.verified ? 'yes' : 'NO'
    ];
  });
  return {
    element: h(
        'article', {class: failed.length || !content.complete ? 'failed' : null},
        head('Campaign', path.split('/').at(-1), words),
        h('ul', {class: 'standing'}, standing.map(([tone, text]) => h('li', {class: tone}, text))),
        section(
            'Success',
            table(
                [
                  'plan', 'trials', 'success probability', 'lower (95 %)', 'upper (95 %)',
                  'plan status', 'verified'
                ],
                rows, {rowClass: i => groups[i].verified ? null : 'fails'})),
        groups.map(group => section(name(group), ...trialParts(group.trials))))
  };
}

/// A share with its interval, \"75 % [67, 84]\", with a bar: the dot is the share.
function shareCell(text) {
  const found = /^(\d+) % \[(\d+), (\d+)\]$/.exec(text);
  if (!found) return text;
  const [value, low, high] = found.slice(1).map(Number);
  const bar =
      svg('svg', {viewBox: '0 0 104 12', class: 'share', 'aria-hidden': 'true'},
          svg('rect', {x: 2, y: 5.5, width: 100, height: 1, class: 'axis'}),
          svg('rect', {x: 2 + low, y: 3, width: Math.max(1, high - low), height: 6, class: 'body'}),
          svg('circle', {cx: 2 + value, cy: 6, r: 3, class: 'mean'}));
  return h('span', {class: 'with-share'}, text, bar);
}

/// Tables and figures as `bench` writes them.
export function benchPage({title, sections}) {
  const first = sections[0];
  return {
    element: h(
        'article', {}, head('Benchmark', title, first?.paragraphs[0] ?? ''),
        sections.map(
            (each, i) => section(
                each.heading, each.paragraphs.slice(i === 0 ? 1 : 0).map(text => h('p', {}, text)),
                each.header.length ? table(
                                         each.header, each.rows.map(row => row.map(shareCell)),
                                         {label: each.heading}) :
                                     null,
                each.figures.length ?
                    plotGrid(
                        each.figures.filter(figure => figure.series.length)
                            .map(figure => new Plot({
                                   title: figure.title,
                                   x_label: figure.x_label,
                                   y_label: figure.y_label,
                                   x: figure.x,
                                   x_name: 'x',
                                   height: 280,
                                   from_zero: true,
                                   series: figure.series.map(
                                       (line, k) => ({...line, dash: k >= 8 ? [6, 4] : undefined})),
                                 }))) :
                    null)))
  };
}
