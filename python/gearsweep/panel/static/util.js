// Small things that all parts use: elements, numbers, units, names.

export const byId = (id) => document.getElementById(id);

/** An element with properties and children; a property with a dash, or of SVG, becomes an attribute. */
export function el(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (name.includes('-') || name === 'for' || name === 'role') node.setAttribute(name, value);
    else if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else node[name] = value;
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

const SVG = 'http://www.w3.org/2000/svg';
export function svg(tag, attributes = {}, ...children) {
  const node = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) if (value !== undefined) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

/** A number as people read it: so many digits, and no long tails. */
export function shown(value, digits = 5) {
  if (value === null || value === undefined) return '–';
  if (typeof value !== 'number') return String(value);
  if (Number.isInteger(value) && Math.abs(value) < 1e7) return String(value).replace('-', '−');
  const size = Math.abs(value);
  const words = size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
  return words.replace('-', '−');
}

const SIGNS = { um: 'µm', deg: '°', 'N m': 'N·m', 'kg m^2': 'kg·m²', 'kg/m^3': 'kg/m³', 'N/um': 'N/µm', mm2: 'mm²', 'N/(mm um)': 'N/(mm·µm)', 'um/N': 'µm/N', 'mPa s': 'mPa·s', 'W/(m K)': 'W/(m·K)', 'J/(kg K)': 'J/(kg·K)', 'kg**-0.5': 'kg^(−1/2)' };
export const unit = (word) => SIGNS[word] ?? word.replaceAll('um', 'µm');

/** What people read for names: of numbers, tasks by what they are for, and words of a case. The server tells them. */
export const names = { numbers: {}, tasks: {}, words: {} };
export const worded = (name) => names.words[name] ?? name.replaceAll('_', ' ');
export const capital = (words) => words.charAt(0).toUpperCase() + words.slice(1);

/** What a key or column is called: its name without the unit, which is shown next to it. */
export function title(name, ofUnit = '') {
  const bare = (word) => word.toLowerCase().replace(/[^a-z0-9]/g, '');
  let words = name.split('_');
  const wanted = bare(ofUnit);
  for (let n = 1; wanted && n < words.length; n++) {
    if (words.slice(-n).join('') === wanted) { words = words.slice(0, -n); break; }
  }
  return words.join(' ').replace(/\brpm\b/, 'speed').replace(/\b[ds]te\b/, (word) => word.toUpperCase());
}

/** Name and unit, for an axis or the head of a column. */
export function labelled(column) {
  if (column.name === 's') return 'Path coordinate s (base pitches)';
  const name = title(column.name, column.unit);
  return column.unit ? `${capital(name)} (${unit(column.unit)})` : capital(name);
}

/** Puts a text or a Blob where the browser puts what it loads. */
export function download(name, content, kind = 'text/plain') {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type: kind }));
  const link = el('a', { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

export const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
export const isDark = () => getComputedStyle(document.documentElement).colorScheme.trim() === 'dark';
