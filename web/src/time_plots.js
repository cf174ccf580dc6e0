// The plots over time, linked to the scene.
import {degrees, digits, h} from './dom.js';
import {poseFrom} from './kinematics.js';
import {Plot} from './plots.js';
import {buttons} from './viewer.js';

/// Which of several lines comes closest to its limits, in parts of their range. @param limits
/// [lower, upper] of each line, null: none
function closestLimit(lines, limits, unit) {
  let closest = null;
  lines.forEach(({name, y}, i) => {
    const [lower, upper] = limits[i];
    const width = lower === null || upper === null ? 1 : upper - lower;
    const range = y.reduce(
        ([low, high], each) => [Math.min(low, each), Math.max(high, each)], [Infinity, -Infinity]);
    const take = (value, limit, room) => {
      if (limit === null || (closest && closest.part <= room / width)) return;
      closest = {name, value, limit, part: room / width};
    };
    take(range[0], lower, range[0] - lower);
    take(range[1], upper, upper - range[1]);
  });
  if (!closest) return 'no limits';
  const {name, value, limit} = closest;
  return `closest to its limit: ${name}, ${digits(value, 3)} of ${digits(limit, 3)} ${unit}`;
}

/// The plots over time, from the approach on through the motion under one controller.
export class TimePlots {
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
    // The arc cosine of a small angle loses half of the digits.
    const angleFrom = ({quaternion}) => {
      const {x, y, z, w} = reference.clone().conjugate().multiply(quaternion);
      return 2 * Math.atan2(Math.hypot(x, y, z), Math.abs(w));
    };
    const rates = columns('base_rates');
    const momenta = columns('momenta');
    const {joints} = this.robot;
    const plots = [
      plot(
          'Base: rotation away from the attitude at the contact', 'deg', [{
            name: 'rotation angle',
            y: base.map(pose => degrees(angleFrom(pose)))
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
      const withLimits = (title, unit, column, factor, range, more = {}) => {
        const lines = series(column, factor).map(each => ({...each, ...more}));
        const limits = of.map(([joint]) => range(joint).map(limit => limit && factor * limit));
        plots.push(plot(title, unit, lines, {
          limits: limits.flat().filter(limit => limit !== null).map(y => ({y})),
          note: closestLimit(lines, limits, unit),
        }));
      };
      const both = limit => [limit === null ? null : -limit, limit];
      withLimits(
          slides ? 'Sliding joints: positions' : 'Joint positions', unit, 'joints', scale,
          joint => [joint.lower, joint.upper]);
      withLimits(
          slides ? 'Sliding joints: rates' : 'Joint rates', `${unit}/s`, 'rates', scale,
          joint => both(joint.max_velocity));
      withLimits(
          slides ? 'Sliding joints: forces' : 'Joint torques', slides ? 'N' : 'N m', 'torques', 1,
          joint => both(joint.max_effort), {steps: true});
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
