// The scene with its controls: time, speed, cameras, layers, ghost, candidates.
import {kCameras} from './cameras.js';
import {degrees, digits, fixed, h} from './dom.js';
import {bodyPoses} from './kinematics.js';
import {Scene} from './scene.js';
import {controllerName} from './standing.js';

const hashOptions = new URLSearchParams(location.hash.slice(1));

/// A choice by buttons of which one is pressed.
export function buttons(label, options, chosen, onChoose) {
  const list = Object.entries(options).map(
      ([key, text]) =>
          h('button', {
            type: 'button',
            'aria-pressed': String(key === chosen),
            onclick: event => {
              for (const other of list)
                other.setAttribute('aria-pressed', String(other === event.currentTarget));
              onChoose(key);
            },
          },
            text));
  return h('div', {class: 'buttons', role: 'group', 'aria-label': label}, list);
}

function toggle(text, on, onChange, title) {
  return h(
      'label', {class: 'toggle', title},
      h('input',
        {type: 'checkbox', checked: on, onchange: event => onChange(event.target.checked)}),
      h('span', {}, text));
}

function select(label, options, chosen, onChange) {
  return h(
      'label', {class: 'select'}, h('span', {}, label),
      h('select', {onchange: event => onChange(Number(event.target.value))},
        options.map(([value, text]) => h('option', {value, selected: value === chosen}, text))));
}

/// Whether WebGL is drawn by the processor: every sample per pixel costs then.
function isSoftware(context) {
  let name = context.getParameter(context.RENDERER);
  if (name === 'WebKit WebGL') {
    const info = context.getExtension('WEBGL_debug_renderer_info');
    if (info) name = context.getParameter(info.UNMASKED_RENDERER_WEBGL);
  }
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

/// @return {context, software}, or null without WebGL 2
function webglContext(canvas) {
  const probe = document.createElement('canvas').getContext('webgl2');
  if (!probe) return null;
  const software = isSoftware(probe);
  probe.getExtension('WEBGL_lose_context')?.loseContext();
  const context =
      canvas.getContext('webgl2', {antialias: !software, alpha: true, preserveDrawingBuffer: true});
  return context ? {context, software} : null;
}

export class Viewer {
  /// @param data the scene's JSON @param motion a Motion
  /// @param options.candidates [{label, joints, base, target}] @param options.onTime
  constructor(data, motion, options) {
    this.data = data;
    this.motion = motion;
    this.options = options;
    this.controller = 0;
    this.ghostChoice = -1;
    this.playing = false;
    this.time = motion.begin;
    this.traces = true;
    this.clearance = true;
    this.canvas = h('canvas', {
      class: 'scene-canvas',
      tabindex: 0,
      'aria-label': 'Scene of robot and target: drag to turn, wheel to zoom'
    });
    this.hud = h('div', {class: 'hud', 'aria-live': 'off'});
    this.frame = h('div', {class: 'scene-frame'}, this.canvas, this.hud);
    const transport = this.makeTransport();
    this.element =
        h('div', {class: 'viewer'}, this.frame, motion.end > motion.begin ? transport : null,
          this.makeTools());
    // Words and plots come first: the scene starts when it is about to be seen.
    this.seen = new IntersectionObserver(entries => {
      if (entries.at(-1).isIntersecting) this.begin();
    }, {rootMargin: '300px'});
    this.seen.observe(this.frame);
  }

  /// Starts the scene unless it has started.
  begin() {
    if (this.begun) return;
    this.begun = true;
    this.seen.disconnect();
    this.start();
  }

  start() {
    const webgl = webglContext(this.canvas);
    if (!webgl) {
      this.frame.replaceChildren(h(
          'p', {class: 'no-webgl'},
          'This browser shows no 3-D scene (WebGL 2 is missing). The plots below say the same in numbers.'));
      this.frame.classList.add('empty');
      return;
    }
    this.view = new Scene(this.canvas, webgl, this.data, this.motion);
    this.view.requestDraw = () => this.requestDraw();
    this.frame.append(this.view.gap.label);
    this.view.paint(this.theme);
    this.resize();
    const camera = hashOptions.get('camera');
    this.view.look(camera in kCameras ? camera : 'free');
    new ResizeObserver(() => this.resize()).observe(this.frame);
    this.refresh();
    this.view.sharpen();
    this.frame.dataset.ready = '';
  }

  makeTransport() {
    const {motion} = this;
    this.playButton =
        h('button',
          {type: 'button', class: 'play', onclick: () => this.togglePlay(), 'aria-label': 'Play'},
          '▶');
    this.slider = h('input', {
      type: 'range',
      min: motion.begin,
      max: motion.end,
      step: 'any',
      value: motion.begin,
      'aria-label': 'Time from the contact, s',
      oninput: event => this.seek(this.nearContact(Number(event.target.value))),
    });
    this.clock = h('output', {class: 'clock'});
    const track = h('div', {class: 'track'}, this.slider, this.phaseBar());
    const speed = select(
        'Speed', [[0.1, '0.1×'], [0.5, '0.5×'], [1, '1×'], [2, '2×'], [5, '5×'], [10, '10×']],
        this.speed = this.defaultSpeed(), value => {
          this.speed = value;
        });
    return h('div', {class: 'transport'}, this.playButton, track, this.clock, speed);
  }

  /// The contact is one instant of the slider: close to it, it is it.
  nearContact(time) {
    return Math.abs(time) < (this.motion.end - this.motion.begin) / 400 ? 0 : time;
  }

  defaultSpeed() {
    const length = this.motion.end - this.motion.begin;
    return length > 120 ? 10 : length > 45 ? 5 : length > 12 ? 2 : 1;
  }

  phaseBar() {
    const {motion} = this;
    if (!motion.contact) return null;
    const length = motion.end - motion.begin || 1;
    const parts = [
      ['approach', motion.begin, motion.waitBegin], ['wait', motion.waitBegin, 0],
      ['after the impact', 0, motion.end]
    ];
    const bar = h('div', {class: 'phases', 'aria-hidden': 'true'});
    for (const [name, from, to] of parts) {
      if (!(to > from)) continue;
      const part =
          h('span', {class: `phase ${name.split(' ')[0]}`, title: name},
            (to - from) / length > 0.1 ? name : '');
      part.style.width = `${100 * (to - from) / length}%`;
      bar.append(part);
    }
    return bar;
  }

  makeTools() {
    const {data, motion, options} = this;
    const row = h('div', {class: 'tools'});
    const cameras = data.target && data.target.feature ?
        kCameras :
        {free: kCameras.free, base: kCameras.base, hand: kCameras.hand};
    row.append(buttons('Camera', cameras, 'free', key => this.look(key)));
    row.append(toggle('Frames', this.frames = options.frames || hashOptions.has('frames'), on => {
      this.frames = on;
      this.refresh();
    }, 'axes: x red, y green, z blue'));
    row.append(toggle('Centroids', this.centroids = Boolean(options.centroids), on => {
      this.centroids = on;
      this.refresh();
    }, 'of base and bodies'));
    if (motion.end > motion.begin) {
      row.append(toggle('Traces', true, on => {
        this.traces = on;
        this.refresh();
      }, 'paths of the hand and of the contact feature'));
    }
    if (motion.approach?.clearances) {
      row.append(toggle('Clearance', true, on => {
        this.clearance = on;
        this.refresh();
      }, 'the closest pair that may not touch, and the gap between them'));
    }
    if (motion.after.length) {
      const names = motion.after.map((record, i) => [i, controllerName(record.controller)]);
      row.append(select('Controller', names, 0, value => {
        this.controller = value;
        this.options.onController?.(value);
        this.refresh();
      }));
      if (names.length > 1) {
        row.append(select('Ghost', [[-1, 'none'], ...names], -1, value => {
          this.ghostChoice = value;
          this.refresh();
        }));
      }
    }
    const {candidates} = this.options;
    if (candidates?.length > 1) {
      row.append(select(
          'Candidate',
          [[-1, 'the plan'], ...candidates.map((candidate, i) => [i, candidate.label])], -1,
          value => {
            this.candidate = value;
            this.refresh();
          }));
    }
    return row;
  }

  /// After it is part of the page.
  connect(theme) {
    this.paint(theme);
    const at = Number(hashOptions.get('t'));
    this.seek(hashOptions.has('t') && Number.isFinite(at) ? at : this.motion.begin);
  }

  paint(theme) {
    this.theme = theme;
    this.view?.paint(theme);
    this.refresh();
  }

  resize() {
    if (!this.view || !this.frame.clientWidth) return;
    this.view.resize(this.frame.clientWidth, this.frame.clientHeight);
    this.requestDraw();
  }

  look(key) {
    this.view?.look(key);
    this.refresh();
  }

  togglePlay() {
    this.playing = !this.playing;
    this.playButton.textContent = this.playing ? '❚❚' : '▶';
    this.playButton.setAttribute('aria-label', this.playing ? 'Pause' : 'Play');
    if (!this.playing) return;
    if (this.time >= this.motion.end) this.seek(this.motion.begin);
    let last = null;
    const step = now => {
      if (!this.playing) return;
      if (last !== null)
        this.seek(Math.min(this.motion.end, this.time + this.speed * (now - last) / 1000));
      last = now;
      if (this.time >= this.motion.end)
        this.togglePlay();
      else
        requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  seek(time) {
    this.time = Math.min(this.motion.end, Math.max(this.motion.begin, time));
    this.slider.value = this.time;
    this.clock.textContent = this.motion.contact ?
        `${this.time < 0 ? '−' : '+'}${Math.abs(this.time).toFixed(2)} s` :
        `${this.time.toFixed(2)} s`;
    this.refresh();
    this.options.onTime?.(this.time);
  }

  refresh() {
    const candidate = this.options.candidates?.[this.candidate ?? -1];
    const state =
        candidate ? this.motion.still(candidate) : this.motion.at(this.time, this.controller);
    this.say(state, candidate);
    if (!this.view) return;
    let ghost = null;
    if (candidate) {
      ghost = this.motion.still(this.motion.contact);
    } else if (this.time > 0 && this.ghostChoice >= 0 && this.ghostChoice !== this.controller) {
      ghost = this.motion.at(this.time, this.ghostChoice);
    }
    if (this.tracesOf !== this.controller) {
      this.view.drawTraces(this.controller);
      this.tracesOf = this.controller;
    }
    this.view.traces.visible = this.traces && !candidate;
    for (const frame of this.view.robot.frames) frame.visible = this.frames;
    for (const dot of this.view.robot.centroids) dot.visible = this.centroids;
    if (this.view.targetFrame) this.view.targetFrame.visible = this.frames;
    this.view.show(state, ghost, candidate ? -1e9 : this.time);
    this.view.markPair(this.clearance && !candidate ? this.nearestNow(state) : null);
    this.requestDraw();
  }

  /// The closest pair of the approach at a state, or null.
  nearestNow(state) {
    const {pairs, nearest, clearances} = (this.time <= 0 && this.motion.approach) || {};
    const pair = pairs?.[state.sample];
    if (!pair) return null;
    return {
      names: pair.split(' with '),
      points: nearest[state.sample],
      distance: clearances[state.sample],
    };
  }

  say(state, candidate) {
    if (candidate) {
      this.hud.replaceChildren(
          h('strong', {}, candidate.label), h('span', {}, candidate.words),
          h('span', {}, 'ghost: the chosen posture'));
      return;
    }
    const record = this.motion.record(this.time, this.controller);
    const lines = [];
    const i = state.sample;
    const line = (label, text) => lines.push(h('span', {}, h('i', {}, label), text));
    for (const [label, text] of this.options.say?.(state) ?? []) line(label, text);
    if (record?.distances?.length) {
      line('hand to feature ', `${digits(record.distances[i], 3)} m`);
      line('closing at ', `${digits(record.closing_speeds[i], 3)} m/s`);
    }
    if (record?.base_rates)
      line(
          'base rate ',
          `${digits(degrees(Math.hypot(...record.base_rates[i].slice(3))), 3)} deg/s`);
    if (this.time <= 0 && record?.clearances?.[i] !== undefined && record.clearances[i] !== null &&
        this.clearance) {
      line(
          'closest pair ',
          `${record.pairs[i].replace(' with ', ' – ')}, ${fixed(record.clearances[i], 3)} m`);
    }
    if (this.view?.ellipsoid && this.view.showsImpulse(this.time)) {
      const {factor, largest} = this.view.ellipsoid;
      line(
          'ellipsoid ',
          `where the feature may be (3 sigma, at most ${digits(largest, 2)} m)` +
              (factor > 1 ? `, drawn ${factor} times larger` : ''));
    }
    const name = this.motion.phase(this.time);
    const who = this.time > 0 && record ? `, ${controllerName(record.controller)}` : '';
    this.hud.replaceChildren(h('strong', {}, name + who), ...lines);
  }

  requestDraw() {
    if (!this.view || this.drawing) return;
    this.drawing = true;
    requestAnimationFrame(() => {
      this.drawing = false;
      this.view.draw();
      this.view.gap.follow(this.view.camera, this.frame.clientWidth, this.frame.clientHeight);
      clearTimeout(this.sharpening);
      this.sharpening = setTimeout(() => this.view.sharpen(), 150);
    });
  }

  /// Keys that act wherever no form field has the focus.
  key(event) {
    const cameras = Object.keys(kCameras);
    if (event.key === ' ')
      this.togglePlay();
    else if (event.key === 'ArrowLeft')
      this.seek(this.time - (event.shiftKey ? 1 : 0.1));
    else if (event.key === 'ArrowRight')
      this.seek(this.time + (event.shiftKey ? 1 : 0.1));
    else if (event.key === 'Home')
      this.seek(this.motion.begin);
    else if (event.key === 'End')
      this.seek(this.motion.end);
    else if (event.key === 'c')
      this.seek(0);
    else if (cameras['1234'.indexOf(event.key)])
      this.element.querySelectorAll('[aria-label="Camera"] button')['1234'.indexOf(event.key)]
          ?.click();
    else
      return false;
    return true;
  }
}
