// The page of `check`: a robot or a problem as it was understood, before anything is planned.
import {digits, h, section} from './dom.js';
import {apply, bodyPoses, compose, handPose, identityPose, poseFrom} from './kinematics.js';
import {sampleAt} from './motion.js';
import {Viewer} from './viewer.js';

/// A posture that sliders change, and the target over the window of contact times.
class StillMotion {
  constructor(scene) {
    this.scene = scene;
    this.after = [];
    this.approach = null;
    this.contact = null;
    this.posture = {...scene.start, joints: [...scene.start.joints]};
    this.window = scene.window ?? null;
    this.begin = this.window ? this.window.times[0] : 0;
    this.end = this.window ? this.window.times.at(-1) : 0;
    this.waitBegin = this.begin;
  }

  phase() {
    return this.window ? 'target over the window of contact times' : 'start posture';
  }

  record() {
    return null;
  }

  at(time) {
    return {
      joints: this.posture.joints,
      base: this.posture.base ? poseFrom(this.posture.base) : identityPose(),
      target: this.window ? sampleAt(this.window, 'target', time) : null,
      sample: 0,
    };
  }
}

/// One slider per joint, between its limits.
function jointSliders(robot, motion, onChange) {
  return h('div', {class: 'joints'}, robot.joints.map((joint, k) => {
    const scale = joint.slides ? 1 : 180 / Math.PI;
    const unit = joint.slides ? 'm' : 'deg';
    const wide = joint.slides ? 1 : Math.PI;
    const text = value => `${digits(scale * value, 4)} ${unit}`;
    const value = h('output', {}, text(motion.posture.joints[k]));
    const slider = h('input', {
      type: 'range',
      min: joint.lower ?? -wide,
      max: joint.upper ?? wide,
      step: 'any',
      value: motion.posture.joints[k],
      'aria-label': `${joint.name}, ${unit}`,
      oninput: event => {
        motion.posture.joints[k] = Number(event.target.value);
        value.textContent = text(motion.posture.joints[k]);
        onChange();
      },
    });
    const end = limit => limit === null ? 'no limit' : text(limit);
    return h(
        'div', {class: 'joint'}, h('b', {}, joint.name), value, slider,
        h('small', {}, end(joint.lower)), h('small', {}, end(joint.upper)));
  }));
}

/// @return {element, connect(theme), paint(theme), key(event)}
export function checkPage({kind, path, title, words, scene}) {
  const motion = new StillMotion(scene);
  const {robot, target} = scene;
  const feature = target?.features.find(each => each.name === target.feature);
  const say = state => {
    if (!feature || !state.target) return [];
    const hand = compose(state.base, handPose(robot, bodyPoses(robot, state.joints)));
    const gap = apply(state.target, feature.point).distanceTo(hand.position);
    return [['hand to feature ', `${digits(gap, 3)} m`]];
  };
  const viewer = new Viewer(scene, motion, {say, frames: true, centroids: true});
  const sliders = jointSliders(robot, motion, () => viewer.refresh());
  const head =
      h('header', {class: 'document-head'}, h('p', {class: 'kicker'}, kind), h('h1', {}, title),
        h('p', {class: 'purpose'}, path));
  const element =
      h('article', {}, head, h('section', {}, viewer.element),
        robot.joints.length ? section('Joints between their limits', sliders) : null,
        section('As it was understood', h('pre', {}, words)));
  element.viewer = viewer;
  return {
    element,
    viewer,
    connect: theme => viewer.connect(theme),
    paint: theme => viewer.paint(theme),
    key: event => viewer.key(event),
  };
}
