// What is known of a plan, and its figures: for its own page and beside other plans.
import {degrees, spaced} from './dom.js';
import {verdictOf} from './verification.js';

const kStatusWords = {
  optimal: 'Optimal configuration',
  feasible: 'Feasible configuration, not shown to be a local optimum',
  limit: 'Best configuration before a limit was reached',
  infeasible: 'No configuration satisfies the constraints',
};

export const approachFails = plan => !['found', 'not_requested'].includes(plan.approach.status);

/// Of a controller in words.
export const controllerName = name => name === 'none' ? 'free joints' : spaced(name);

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
