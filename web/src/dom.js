// Elements and numbers. Text is only ever put into text nodes: nothing in a file becomes markup.

/// An element with attributes and children (elements, texts, or null for nothing).
export function h(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === false || value === null || value === undefined) continue;
    if (key.startsWith('on')) {
      element.addEventListener(key.slice(2), value);
    } else {
      element.setAttribute(key, value === true ? '' : value);
    }
  }
  element.append(...children.flat().filter(child => child !== null && child !== undefined));
  return element;
}

export const degrees = x => x * 180 / Math.PI;

/// Four significant digits, a minus sign that can be seen, and zero for what rounding leaves.
export function digits(x, count = 4) {
  if (x === null || x === undefined || !Number.isFinite(x)) return '–';
  if (Math.abs(x) < 1e-9) return '0';
  const size = Math.abs(x);
  const rounded = Number(x.toPrecision(count));
  const text = size >= 1e-3 && size < 1e5 ? String(rounded) : rounded.toExponential();
  return text.replace('-', '−');
}

export const fixed = (x, places) => x.toFixed(places).replace('-', '−');

/// A table. Numbers stand to the right; null is a number that there is not.
export function table(header, rows, options = {}) {
  const cell = value => {
    if (value instanceof Node) return h('td', {}, value);
    if (typeof value === 'number' || value === null)
      return h('td', {class: 'number'}, digits(value));
    return h('td', {}, String(value ?? ''));
  };
  const isNumber = k =>
      rows.length > 0 && rows.every(row => row[k] === null || typeof row[k] === 'number');
  const head =
      header.map((name, k) => h('th', {scope: 'col', class: isNumber(k) ? 'number' : null}, name));
  const body = rows.map((row, i) => h('tr', {class: options.rowClass?.(i)}, row.map(cell)));
  const label = options.label ?? header.join(', ');
  return h(
      'div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': label},
      h('table', {class: options.class}, h('thead', {}, h('tr', {}, head)), h('tbody', {}, body)));
}

export function section(title, ...children) {
  return h('section', {}, h('h2', {}, title), ...children);
}

/// Words with spaces for names with underscores.
export const spaced = name => String(name).replaceAll('_', ' ');
