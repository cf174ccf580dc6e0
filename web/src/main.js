// Reads the data of the page and shows one document at a time.
import {checkPage} from './check.js';
import {h, table} from './dom.js';
import {planPage} from './plan.js';
import {repaint} from './plots.js';
import {analysisPage, benchPage, campaignPage, paretoPage} from './results.js';
import {figures, standing} from './standing.js';
import {verificationPage} from './verification.js';

const kPages = {
  plan: planPage,
  problem: checkPage,
  robot: checkPage,
  verification: verificationPage,
  analysis: analysisPage,
  pareto: paretoPage,
  campaign_result: campaignPage,
  bench: benchPage,
};

const data = JSON.parse(document.getElementById('data').textContent);
const main = document.getElementById('page');
let shown = null;

const prefersDark = matchMedia('(prefers-color-scheme: dark)');
let stated = null;
const theme = () => stated ?? (prefersDark.matches ? 'dark' : 'light');

function applyTheme() {
  document.documentElement.dataset.theme = theme();
  repaint();
  shown?.paint?.(theme());
}

const titleOf = each => each.kind === 'plan' ? each.content.problem.name :
                                               each.title ?? each.content?.problem ?? each.path;

/// Several plans by their figures, side by side.
function comparison(plans) {
  const columns = plans.map(figures);
  const labels =
      [...new Set(columns.flatMap(rows => rows.map(([label, , unit]) => `${label}, ${unit}`)))];
  const rows =
      labels.map(label => [label, ...columns.map(column => {
                   const row = column.find(([name, , unit]) => `${name}, ${unit}` === label);
                   return row ? row[1] : '–';
                 })]);
  rows.push([
    'standing',
    ...plans.map(
        plan =>
            h('ul', {class: 'standing'},
              standing(plan).map(([tone, text]) => h('li', {class: tone}, text))))
  ]);
  return h(
      'section', {class: 'comparison'}, h('h2', {}, 'Side by side'),
      table(['figure, unit', ...plans.map(titleOf)], rows, {class: 'compare'}));
}

const holder = h('div', {});
const tabs = h('nav', {class: 'tabs', 'aria-label': 'Documents'});

function show(index) {
  const each = data.documents[index];
  tabs.querySelectorAll('button').forEach(
      (button, i) => button.setAttribute('aria-pressed', String(i === index)));
  shown = kPages[each.kind](each);
  holder.replaceChildren(shown.element);
  document.title = `${titleOf(each)} – stillbase`;
  shown.connect?.(theme());
}

document.documentElement.dataset.theme = theme();
prefersDark.addEventListener('change', applyTheme);
main.append(
    h('div', {class: 'bar'}, h('span', {class: 'brand'}, 'stillbase'), tabs,
      h('button', {
        type: 'button',
        class: 'theme',
        'aria-label': 'Light or dark',
        onclick: () => {
          stated = theme() === 'dark' ? 'light' : 'dark';
          applyTheme();
        }
      },
        '◐')));
if (data.documents.length > 1) {
  data.documents.forEach(
      (each, i) =>
          tabs.append(h('button', {type: 'button', onclick: () => show(i)}, titleOf(each))));
}
const plans = data.documents.filter(each => each.kind === 'plan');
if (plans.length > 1) main.append(comparison(plans));
main.append(
    holder,
    h('footer', {},
      `Made by stillbase ${
          data.stillbase}. This page is one file and asks nothing of the network.`));
show(0);

addEventListener('keydown', event => {
  if (event.ctrlKey || event.metaKey || event.altKey ||
      event.target.closest('input, select, textarea, summary, button'))
    return;
  if (shown?.key?.(event)) event.preventDefault();
});
// Paper is light, and has nothing to unfold.
let before = null;
addEventListener('beforeprint', () => {
  before = stated;
  stated = 'light';
  shown?.viewer?.begin();
  applyTheme();
  document.querySelectorAll('details').forEach(details => details.setAttribute('open', ''));
});
addEventListener('afterprint', () => {
  stated = before;
  applyTheme();
});
