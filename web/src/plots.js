// Plots with uPlot: one look, a line at the current time, limits as dashed lines.
import uPlot from 'uplot';

import {digits, h} from './dom.js';

const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export const seriesColor = i => css(`--series-${i % 8}`);

const all = new Set();

/// Redraws every plot in the colours of the theme.
export function repaint() {
  for (const plot of all) plot.build();
}

/// A plot of columns over x.
///
/// @param options.title, x_label, y_label with units
/// @param options.x ascending
/// @param options.series [{name, y, color?, dash?, width?, points?, band?: {low, high}}]
/// @param options.limits [{y, color}] dashed; they do not widen the axis
/// @param options.marks [{x, label}]
/// @param options.onSeek called with the x that was clicked
/// @param options.band [name of lower, name of upper]
/// @param options.note a line below the plot
export class Plot {
  constructor(options) {
    this.options = options;
    this.element = h('figure', {class: 'plot'}, h('figcaption', {}, options.title));
    this.holder = h('div', {class: 'plot-area'});
    this.element.append(this.holder);
    if (options.note) this.element.append(h('p', {class: 'plot-note'}, options.note));
    this.visible = false;
    new IntersectionObserver(entries => {
      this.visible = entries.at(-1).isIntersecting;
      if (this.visible) {
        if (!this.plot) this.build();
        this.showTime();
      }
    }, {rootMargin: '200px'}).observe(this.element);
    new ResizeObserver(() => {
      if (this.plot && this.width() !== this.plot.width)
        this.plot.setSize({width: this.width(), height: this.height()});
      this.showTime();
    }).observe(this.holder);
    all.add(this);
  }

  width() {
    return Math.max(240, Math.floor(this.holder.clientWidth));
  }

  height() {
    return this.options.height ?? 190;
  }

  build() {
    const {options} = this;
    if (!this.holder.isConnected) return;
    this.plot?.destroy();
    const ink = css('--quiet');
    const axis = {
      stroke: ink,
      font: '12px system-ui, sans-serif',
      labelFont: '12px system-ui, sans-serif',
      grid: {stroke: css('--grid'), width: 1},
      ticks: {stroke: css('--grid'), width: 1, size: 4},
      labelGap: 2,
    };
    const tick = (u, values) => values.map(
        value => value === null ? '' : String(Number(value.toPrecision(6))).replace('-', '−'));
    this.plot =
        new uPlot(
            {
              width: this.width(),
              height: this.height(),
              padding: [10, 12, 0, 0],
              cursor: {
                drag: {x: false, y: false},
                points: {size: 6},
                sync: options.onSeek ? {key: options.sync ?? 'time', setSeries: false} : undefined,
              },
              legend: {live: true},
              scales: {
                x: {
                  time: false,
                  range: options.series.some(series => series.points) ?
                      (u, low, high) => this.range(low, high) :
                      undefined
                },
                y: {range: (u, low, high) => this.range(low, high)}
              },
              axes: [
                {...axis, label: options.x_label, labelSize: 18, size: 28, values: tick},
                {...axis, label: options.y_label, labelSize: 18, size: 52, values: tick},
              ],
              series: [
                {label: options.x_name ?? 't', value: (u, x) => x === null ? '–' : digits(x)},
                ...options.series.map(
                    (series, i) => ({
                      label: series.name,
                      stroke: series.color ? css(series.color) : seriesColor(i),
                      width: series.width ?? 1.6,
                      dash: series.dash,
                      paths: series.points ? () => null :
                          series.steps     ? uPlot.paths.stepped({align: 1}) :
                                             undefined,
                      points: series.points ?
                          {show: true, size: 6, fill: css('--paper'), width: 1.5} :
                          {show: false},
                      pxAlign: 0,
                      value: (u, y) => digits(y, 3),
                    })),
              ],
              bands:
                  options.bands?.map(
                      ([upper, lower]) => ({series: [upper, lower], fill: `${css('--accent')}22`})),
              hooks:
                  {
                    drawAxes: [u => this.drawBands(u)],
                    draw: [u => this.drawLines(u)],
                    ready: [() => this.begin()]
                  },
            },
            [options.x, ...options.series.map(series => series.y)], this.holder);
  }

  /// The plot exists: the time line lies over it.
  begin() {
    queueMicrotask(() => {
      this.timeLine = h('div', {class: 'time-line'});
      this.plot.over.append(this.timeLine);
      const {onSeek} = this.options;
      if (onSeek)
        this.plot.over.addEventListener(
            'click', () => onSeek(this.plot.posToVal(this.plot.cursor.left, 'x')));
      if (this.span) this.setSpan(this.span);
      this.showTime();
    });
  }

  range(low, high) {
    if (low === null) return [0, 1];
    const least = this.options.from_zero ? Math.min(0, low) : low;
    const margin = (high - least) * 0.06 || Math.abs(high) * 0.1 || 1;
    return [this.options.from_zero && least === 0 ? 0 : least - margin, high + margin];
  }

  /// Bands of series, below their lines.
  drawBands(u) {
    const {ctx, bbox} = u;
    const {series, x} = this.options;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.globalAlpha = 0.13;
    series.forEach(({band, color}, i) => {
      if (!band || !u.series[i + 1].show) return;
      const to = values =>
          values.map((y, k) => [u.valToPos(x[k], 'x', true), u.valToPos(y, 'y', true)]);
      ctx.fillStyle = color ? css(color) : seriesColor(i);
      ctx.beginPath();
      for (const [px, py] of [...to(band.low), ...to(band.high).reverse()]) ctx.lineTo(px, py);
      ctx.fill();
    });
    ctx.restore();
  }

  drawLines(u) {
    const {ctx, bbox} = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([5 * devicePixelRatio, 4 * devicePixelRatio]);
    for (const limit of this.options.limits ?? []) {
      ctx.globalAlpha = 0.55;
      ctx.strokeStyle = limit.color ?? css('--fail');
      const y = u.valToPos(limit.y, 'y', true);
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
    }
    ctx.globalAlpha = 1;
    ctx.strokeStyle = ctx.fillStyle = css('--quiet');
    ctx.textAlign = 'left';
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    for (const mark of this.options.marks ?? []) {
      const x = u.valToPos(mark.x, 'x', true);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      ctx.fillText(mark.label, x + 4 * devicePixelRatio, bbox.top + 11 * devicePixelRatio);
    }
    ctx.restore();
  }

  /// Shows a part of the axis; null: all of it.
  setSpan(span) {
    this.span = span;
    if (!this.plot) return;
    const {x} = this.options;
    const [min, max] = span ?? [x[0], x.at(-1)];
    this.plot.setScale('x', {min, max});
    this.showTime();
  }

  /// The line at a time; the legend shows the values there.
  setTime(time) {
    this.time = time;
    if (this.visible) this.showTime();
  }

  showTime() {
    if (!this.timeLine || this.time === undefined) return;
    const x = this.plot.valToPos(this.time, 'x');
    this.timeLine.style.transform = `translateX(${x}px)`;
    this.timeLine.style.display = x >= 0 && x <= this.plot.over.clientWidth ? 'block' : 'none';
    const now = performance.now();
    if (this.plot.cursor.left >= 0 || (now - (this.legendAt ?? 0) < 120 && this.time !== 0)) return;
    this.legendAt = now;
    this.plot.setLegend({idx: this.plot.valToIdx(this.time)});
  }
}

/// Plots below and beside each other.
export function plotGrid(plots) {
  return h('div', {class: 'plots'}, plots.map(plot => plot.element));
}
