// Trials with random errors: how often the capture succeeds, the spread of each figure, and what it
// depends on.
import {digits, h, spaced, table} from './dom.js';

const kSvg = 'http://www.w3.org/2000/svg';

export function svg(name, attributes, ...children) {
  const element = document.createElementNS(kSvg, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/// 5th to 95th percentile as a bar, median, mean with its interval, 99th percentile and worst case.
function strip(row) {
  const width = 360;
  const marks = [row.p5, row.p50, row.p95, row.p99, row.worst, row.mean];
  const low = Math.min(0, ...marks);
  const high = Math.max(...marks) || 1;
  const at = value => 6 + (width - 12) * (value - low) / (high - low);
  const bar = (from, to, y, height, cls) =>
      svg('rect',
          {x: at(from), y, width: Math.max(0.5, at(to) - at(from)), height, class: cls, rx: 1.5});
  return svg(
      'svg', {
        viewBox: `0 0 ${width} 26`,
        class: 'strip',
        role: 'img',
        'aria-label': `${row.name}: 5th percentile ${digits(row.p5)}, median ${
            digits(row.p50)}, worst ${digits(row.worst)} ${row.unit}`
      },
      bar(low, high, 12.5, 1, 'axis'), bar(row.p5, row.p95, 6, 14, 'body'),
      bar(row.p95, row.p99, 10, 6, 'tail'),
      svg('line', {x1: at(row.p50), x2: at(row.p50), y1: 3, y2: 23, class: 'median'}),
      svg('circle', {cx: at(row.mean), cy: 13, r: 3, class: 'mean'}),
      svg('line', {x1: at(row.worst), x2: at(row.worst), y1: 6, y2: 20, class: 'worst'}));
}

export function trialParts(trials) {
  const interval = trials.success_interval;
  const percent = x => `${digits(100 * x, 3)} %`;
  const drives = name => {
    const list = [...(trials.sensitivities?.[name] ?? [])]
                     .filter(each => each.rank_correlation !== null)
                     .sort((a, b) => Math.abs(b.rank_correlation) - Math.abs(a.rank_correlation));
    return list.length ? `${spaced(list[0].input)} (${digits(list[0].rank_correlation, 2)})` : '–';
  };
  const parts =
      [h('p', {}, h('b', {}, percent(trials.success_probability)),
         ` of ${trials.count} trials succeed, between ${percent(interval.lower)} and ${
             percent(interval.upper)} with ${percent(interval.confidence)} confidence (${
             interval.method.replace(/^./, first => first.toUpperCase())}). ` +
             `The hand touched the target in ${trials.hits}, the simulation finished in ${
                 trials.finished}.` +
             (trials.interrupted ? ` Interrupted: ${trials.wanted} were wanted.` : ''))];
  parts.push(table(
      [
        'figure', 'unit', 'spread', 'median', 'mean', '95 %', '99 %', 'worst',
        'depends most on (rank correlation)'
      ],
      trials.distributions.map(
          row =>
              [spaced(row.name), h('span', {class: 'unit'}, row.unit), strip(row), row.p50,
               row.mean, row.p95, row.p99, row.worst, drives(row.name)]),
      {label: 'Distributions'}));
  parts.push(h(
      'p', {class: 'quiet'},
      'Bar: 5th to 95th percentile, thin to the 99th; line: median; dot: mean; red: worst case.'));
  parts.push(
      h('details', {}, h('summary', {}, 'Sizes of the random errors'),
        table(
            ['error', 'size (SI units)'],
            Object.entries(trials.perturbations).map(([name, size]) => [spaced(name), size]))));
  return parts;
}
