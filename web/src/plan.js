// The page of a plan: words first, then scene and plots, then what the words rest on.
import {digits, fixed, h, section} from './dom.js';
import {Motion} from './motion.js';
import {binding, candidateTable, grasp, inputs, risks, spreads} from './plan_sections.js';
import {approachFails, figures, standing} from './standing.js';
import {TimePlots} from './time_plots.js';
import {verificationParts} from './verification.js';
import {Viewer} from './viewer.js';

/// Topics of the summary by what they answer.
const kQuestions = [
  ['What was decided', ['found', 'choice', 'posture', 'base', 'contact', 'impulse', 'free', 'turns']],
  ['How good it is', ['momentum', 'case', 'binding', 'approach', 'afterwards']],
  ['How sure it is', ['search', 'certificate', 'coverage', 'curves', 'proof', 'solvers']],
];

function tiles(document) {
  const rows = figures(document).map(([label, value, unit]) => [label, digits(value, 3), unit]);
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
        risks(document), spreads(document), binding(document),
        grasp(document), candidateTable(document),
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
