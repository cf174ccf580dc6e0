// Verdict and checks of a verification: failures first and named, the others by group.
import {h, section, spaced, table} from './dom.js';
import {trialParts} from './trials.js';

/// [tone, words]
export function verdictOf(verification) {
  if (!verification) return ['warn', 'Not verified'];
  const {claims} = verification;
  const failed = claims.filter(claim => claim.pass === false);
  const open = claims.filter(claim => claim.pass === null);
  const more = open.length ? `, ${open.length} could not be made` : '';
  if (verification.verdict === 'pass') {
    return [
      'pass', `Verified: ${claims.length - open.length} of ${claims.length} checks hold${more}`
    ];
  }
  return [
    'fail',
    `Verification failed: ${failed.length} of ${claims.length} checks${more}` +
        (failed.length ? ` (${failed.slice(0, 3).map(claim => spaced(claim.name)).join(', ')}${
                             failed.length > 3 ? ', …' : ''})` :
                         '')
  ];
}

const kHeader = ['check', 'value', 'limit', 'unit', 'detail'];

const rows = claims => claims.map(
    claim =>
        [spaced(claim.name), claim.value, claim.limit, claim.unit === '1' ? '' : claim.unit,
         claim.detail ?? '']);

/// The section; null without a verification.
export function verificationParts(verification) {
  if (!verification) return null;
  const {claims} = verification;
  const failed = claims.filter(claim => claim.pass === false);
  const open = claims.filter(claim => claim.pass === null);
  const groups = [...new Set(claims.map(claim => claim.group))];
  const [verdict, words] = verdictOf(verification);
  const parts = [h('p', {class: `verdict ${verdict}`}, words)];
  if (failed.length)
    parts.push(
        h('h3', {class: 'fail'}, 'Failed'),
        table(kHeader, rows(failed), {rowClass: () => 'fails'}));
  if (open.length) parts.push(h('h3', {}, 'Could not be made'), table(kHeader, rows(open)));
  for (const group of groups) {
    const of = claims.filter(claim => claim.group === group);
    const bad = of.filter(claim => claim.pass === false).length;
    const held = of.filter(claim => claim.pass === true);
    const [tone, sign] = bad    ? ['fail', '✕'] :
        held.length < of.length ? ['warn', '!'] :
                                  ['pass', '✓'];
    if (!held.length) continue;
    parts.push(
        h('details', {},
          h('summary', {}, h('span', {class: `mark ${tone}`}, sign), ` ${spaced(group)} `,
            h('span', {class: 'quiet'}, `${held.length} of ${of.length} hold`)),
          table(kHeader, rows(held))));
  }
  const runs = verification.post_impact;
  if (runs?.length) {
    parts.push(
        h('h3', {}, 'Motion after the impact, by the verification’s own dynamics'),
        table(
            [
              'controller', 'base rate at the end, deg/s', 'attitude change, deg',
              'joint rates at the end, rad/s', 'peak torque, N m', 'limits reached'
            ],
            runs.map(
                run =>
                    [spaced(run.controller), run.residual_base_rate * 180 / Math.PI,
                     run.attitude_turned * 180 / Math.PI, run.residual_joint_rate,
                     run.peak_joint_torque,
                     (run.limits_met ?? []).length ? JSON.stringify(run.limits_met) : 'none'])));
  }
  if (verification.trials)
    parts.push(h('h3', {}, 'Trials with random errors'), ...trialParts(verification.trials));
  return section('Verification', ...parts);
}

/// The page of a verification whose plan is not there.
export function verificationPage(document) {
  const {content} = document;
  return {
    element:
        h('article', {},
          h('header', {class: 'document-head'}, h('p', {class: 'kicker'}, 'Verification'),
            h('h1', {}, document.path),
            h('p', {class: 'purpose'},
              `Of the plan with the fingerprint ${content.content_sha256}.`)),
          verificationParts(content))
  };
}
