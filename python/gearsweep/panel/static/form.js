// The left side: a field for each key that the library declares, with its unit, its default and the library's message.
import { byId, capital, el, names, title, unit, worded } from './util.js';

/** Groups in the order of the hand, and the keys that are shown before `more` is asked for; all others follow. */
const FIRST = {
  case: ['tasks'],
  pinion: ['teeth', 'profile_shift', 'addendum', 'effective_mass_kg', 'crowning_um', 'end_relief_um', 'end_relief_mm'],
  gear: ['teeth', 'profile_shift', 'addendum', 'effective_mass_kg', 'crowning_um', 'end_relief_um', 'end_relief_mm'],
  pair: ['module_mm', 'face_width_mm', 'pressure_angle_deg', 'centre_distance_mm', 'backlash_um'],
  load: ['torque_nm', 'normal_force_n', 'line_load_n_mm'],
  face: ['misalignment_um', 'shaft_diameter_mm', 'bearing_span_mm', 'bearing_offset_mm', 'torque_side'],
  sweep: ['rpm_first', 'rpm_last', 'rpm_step', 'load_rpm'],
  relief: ['amount_um', 'pinion_fraction', 'gear_fraction', 'start', 'shape'],
  dynamics: ['damping_ratio', 'friction'],
  mesh: ['model'],
  as_built: ['turn_rpm', 'waterfall'],
  deviations: ['pinion_class', 'gear_class', 'draws', 'assembly'],
};
const OPEN = ['case', 'pinion', 'gear', 'pair', 'load', 'face', 'sweep', 'relief', 'dynamics'];
const NAMES = { case: 'Compute', face: 'Misalignment and shaft', sweep: 'Speed', relief: 'Tip relief', dynamics: 'Damping and friction', mesh: 'Stiffness of the mesh', section: 'Body behind the teeth' };

let about = null, change = null, slide = null;
const fields = new Map();

const idOf = (group, key) => `${group}.${key}`;
const wordsOf = (key) => key.words.length ? [...key.allowed.matchAll(/'([^']*)'/g)].map((found) => found[1]) : [];
const plain = (raw) => /^'(?:[^']|'')*'$/.test(raw ?? '') ? raw.slice(1, -1).replaceAll("''", "'") : raw ?? '';
const listed = (raw) => [...(raw ?? '').matchAll(/'((?:[^']|'')*)'|([^\s,']+)/g)].map((found) => found[1] ?? found[2]);

/** Builds all fields; `onchange(group, key, value)` is called at each change, `onslide` while a slider moves. */
export function build(description, onchange, onslide) {
  about = description;
  change = onchange;
  slide = onslide;
  const place = byId('groups');
  const order = [...Object.keys(FIRST), ...about.groups.map((group) => group.name)];
  for (const name of new Set(order)) {
    const group = about.groups.find((one) => one.name === name);
    if (group) place.append(groupOf(group));
  }
  byId('find').addEventListener('input', find);
}

function groupOf(group) {
  const rank = (key) => { const at = (FIRST[group.name] ?? []).indexOf(key.name); return at < 0 ? 99 : at; };
  const keys = about.keys.filter((key) => key.group === group.name).sort((a, b) => rank(a) - rank(b));
  const more = el('button', { type: 'button', className: 'more' });
  const body = el('div', { className: 'keys' }, ...keys.map(fieldOf));
  const name = NAMES[group.name] ?? capital(worded(group.name));
  const block = el('details', { open: OPEN.includes(group.name), id: `group.${group.name}` },
    el('summary', {}, el('span', { className: 'groupname' }, name), el('span', { className: 'groupnote' })),
    el('p', { className: 'error', id: `error.${group.name}`, hidden: true }),
    el('p', { className: 'hint' }, group.meaning), body, more);
  more.addEventListener('click', () => { block.classList.toggle('all'); refreshMore(block); });
  return block;
}

function fieldOf(key) {
  const id = idOf(key.group, key.name), words = wordsOf(key);
  const field = { key, row: null, input: null, set: null };
  const change_ = (value) => change(key.group, key.name, value);
  if (key.list && words.length) Object.assign(field, boxes(key, words, change_));
  else if (words.length || key.kind === 'logical') Object.assign(field, choice(key, words, change_));
  else Object.assign(field, entry(key, change_));
  const label = title(key.name, key.unit);
  const error = el('p', { className: 'error', id: `error.${id}`, hidden: true });
  const hint = el('p', { className: 'hint', id: `hint.${id}` }, hintOf(key));
  const isWide = key.list && words.length > 0;
  // Words that a narrow select would cut, of which the default has one more behind it, are below their label.
  const isLong = words.some((word) => worded(word).length + (word === plain(key.default ?? '') ? ' (default)'.length : 0) > 14);
  field.error = error;
  field.row = el('div', { className: isWide ? 'field wide' : key.list || isLong ? 'field list' : 'field', id: `field.${id}` },
    isWide ? el('span', { className: 'label', id: `label.${id}` }, label)
      : el('label', { for: id, title: `&${key.group} ${key.name}` }, label, key.unit ? el('span', { className: 'unit' }, unit(key.unit)) : null),
    field.box, error, hint);
  fields.set(id, field);
  return field.row;
}

function hintOf(key) {
  const usual = key.default !== null && key.default !== "''" ? `Default ${key.default}${key.otherwise ? ` (${key.otherwise})` : ''}.` : key.otherwise ? `If left out: ${key.otherwise}.` : '';
  const allowed = wordsOf(key).length || key.kind === 'logical' || key.allowed === 'text' ? '' : `Allowed: ${key.allowed}.`;
  const forTasks = key.tasks.length && key.tasks.length <= 6 ? `For ${key.tasks.join(', ')}.` : '';
  return [`${capital(key.meaning)}.`, allowed, usual, forTasks, `In the case: &${key.group} ${key.name}`].filter(Boolean).join(' ');
}

function choice(key, words, change_) {
  const id = idOf(key.group, key.name);
  const options = key.kind === 'logical' ? [['.true.', 'yes'], ['.false.', 'no']] : words.map((word) => [word, worded(word)]);
  const input = el('select', { id, 'aria-describedby': `error.${id} hint.${id}` }, el('option', { value: '' }, ''), ...options.map(([value, name]) => el('option', { value }, name)));
  input.addEventListener('change', () => change_(input.value || null));
  const set = (raw, usual) => {
    const value = key.kind === 'logical' ? truth(raw) : plain(raw);
    if (![...input.options].some((one) => one.value === value)) input.append(el('option', { value }, value));
    input.value = value;
    const normal = key.kind === 'logical' ? ({ '.true.': 'yes', '.false.': 'no' })[usual] : worded(plain(usual));
    input.options[0].textContent = normal ? `${normal} (default)` : '(not given)';
  };
  return { input, box: input, set };
}

const truth = (raw) => raw === undefined || raw === '' ? '' : /^\.?t/i.test(raw) ? '.true.' : /^\.?f/i.test(raw) ? '.false.' : raw;

function boxes(key, words, change_) {
  const id = idOf(key.group, key.name);
  const chip = (word) => {
    const task = key.name === 'tasks' ? about.tasks.find((one) => one.name === word) : null;
    return el('label', { title: task?.meaning, className: 'chip' }, el('input', { type: 'checkbox', value: word, id: `${id}.${word}` }), worded(word));
  };
  const parts = key.name === 'tasks' ? Object.entries(names.tasks) : [['', words]];
  const checks = parts.flatMap(([, some]) => some).map(chip);
  const box = el('div', { className: 'chips', role: 'group', 'aria-labelledby': `label.${id}` },
    ...parts.flatMap(([name, some]) => [name ? el('span', { className: 'chipgroup' }, name) : null, ...some.map((word) => checks.find((one) => one.firstChild.value === word))]));
  const inputs = checks.map((one) => one.firstChild);
  box.addEventListener('change', () => {
    const chosen = inputs.filter((one) => one.checked).map((one) => one.value);
    change_(chosen.length ? chosen.map((one) => `'${one}'`).join(', ') : null);
  });
  const set = (raw, usual) => {
    const chosen = listed(raw || usual);
    for (const one of inputs) one.checked = chosen.includes(one.value);
  };
  return { input: inputs[0], box, set };
}

function entry(key, change_) {
  const id = idOf(key.group, key.name), isNumber = key.kind !== 'text';
  const input = el('input', { id, type: 'text', spellcheck: false, inputMode: isNumber && !key.list ? 'decimal' : 'text', 'aria-describedby': `error.${id} hint.${id}` });
  let timer = 0;
  let sent = '';  // leaving a field sends nothing that was sent while it was typed
  const send = () => {
    clearTimeout(timer);
    if (input.value !== sent) change_(input.value.trim() === '' ? null : input.value);
    sent = input.value;
  };
  input.addEventListener('input', () => { clearTimeout(timer); timer = setTimeout(send, 120); tell(); });
  input.addEventListener('change', send);
  // Commas part the numbers of a list.
  const note = el('p', { className: 'note', hidden: true });
  const tell = () => {
    note.hidden = !(isNumber && key.list && /\d,\d/.test(input.value));
    note.textContent = `Read as ${input.value.split(/[\s,]+/).filter(Boolean).join(' and ')}: decimals take a point.`;
  };
  const parts = [input, note];
  if (isNumber) {
    parts.push(sliderOf(key, input, change_));
    input.addEventListener('keydown', (event) => {
      if (event.key === 'ArrowUp' || event.key === 'ArrowDown') { event.preventDefault(); nudge(key, input, event.key === 'ArrowUp' ? 1 : -1); send(); }
    });
  }
  const set = (raw, usual) => {
    // What somebody is typing or sliding is not written over by an earlier state of it.
    if (!parts.includes(document.activeElement)) sent = input.value = key.kind === 'text' ? plain(raw) : raw ?? '';
    tell();
    input.placeholder = plain(usual) || (key.required ? 'required' : '');
  };
  return { input, box: el('div', { className: 'entry' }, ...parts), set };
}

/** The number of a field, or of a list the one where the caret stands: its value, and where its letters are. */
function numberAt(input) {
  const found = [...input.value.matchAll(/[^\s,]+/g)];
  const caret = input.selectionStart ?? input.value.length;
  const one = found.find((part) => part.index + part[0].length >= caret) ?? found[found.length - 1];
  if (!one || !/^[-+]?[\d.]+(e[-+]?\d+)?$/i.test(one[0])) return null;
  return { value: Number(one[0]), from: one.index, to: one.index + one[0].length, which: found.indexOf(one) + 1, of: found.length };
}

function put(input, at, value) {
  const words = String(Number(value.toPrecision(6)));
  input.value = input.value.slice(0, at.from) + words + input.value.slice(at.to);
  input.setSelectionRange(at.from + words.length, at.from + words.length);
  return { ...at, to: at.from + words.length };
}

function nudge(key, input, way) {
  const at = numberAt(input) ?? (input.placeholder && !input.value ? startFrom(input) : null);
  if (!at) return;
  const size = key.kind === 'integer' ? 1 : 10 ** Math.floor(Math.log10(Math.abs(at.value) || 1) - 1);
  put(input, at, within(key, Number((at.value + way * size).toPrecision(10))));
}

function startFrom(input) {
  input.value = input.placeholder;
  return numberAt(input);
}

const within = (key, value) => Math.min(key.high ?? Infinity, Math.max(key.low ?? -Infinity, value));

/** A slider around the number that stands there, which shows while the field has the focus. */
function sliderOf(key, input, change_) {
  const slider = el('input', { type: 'range', className: 'slider', tabIndex: 0, 'aria-label': `${title(key.name, key.unit)}, slider` });
  const set = () => {
    const at = numberAt(input) ?? (input.value === '' && input.placeholder ? numberAt({ value: input.placeholder, selectionStart: 0 }) : null);
    slider.disabled = !at;
    if (!at) return;
    const isWhole = key.kind === 'integer', span = Math.abs(at.value) || (key.high !== null && key.high <= 100 ? key.high : 10);
    const low = within(key, at.value - span * (at.value === 0 ? 0 : 0.6)), high = within(key, at.value + span * (at.value === 0 ? 1 : 0.6));
    slider.min = isWhole ? Math.floor(low) : low;
    slider.max = isWhole ? Math.max(Math.ceil(high), Math.floor(low) + 4) : high;
    slider.step = isWhole ? 1 : Number(((high - low) / 240).toPrecision(1)) || 'any';
    slider.value = at.value;
    slider.title = at.of > 1 ? `value ${at.which} of ${at.of}: the one at the caret` : '';
  };
  input.addEventListener('focus', set);
  input.addEventListener('click', set);
  input.addEventListener('keyup', (event) => { if (event.key.startsWith('Arrow') || event.key === 'Home' || event.key === 'End') set(); });
  input.addEventListener('input', set);
  let at = null;
  slider.addEventListener('input', () => {
    at = numberAt(input) ?? startFrom(input);
    put(input, at, Number(slider.value));
    slide(key.group, key.name, input.value);
  });
  slider.addEventListener('change', () => change_(input.value));
  return slider;
}

/** Shows a case: what is given in the fields, what is in effect behind them, and the message where it belongs. */
export function refresh(state) {
  const tasks = listed(state.given.case?.tasks || state.values.case?.tasks || about.keys.find((key) => key.group === 'case' && key.name === 'tasks').default);
  for (const { key, set, row, input } of fields.values()) {
    const given = state.given[key.group]?.[key.name];
    set(given, state.values[key.group]?.[key.name] ?? key.default ?? '');
    const serves = key.tasks.length === 0 || key.tasks.some((task) => tasks.includes(task));
    const isFirst = (FIRST[key.group] ?? []).includes(key.name) || (key.required && serves);
    row.classList.toggle('given', given !== undefined);
    row.classList.toggle('idle', !serves);
    row.classList.toggle('first', given !== undefined || (isFirst && serves));
    input.removeAttribute('aria-invalid');
  }
  for (const block of document.querySelectorAll('#groups details')) {
    const group = block.id.slice(6), used = about.keys.some((key) => key.group === group && (key.tasks.length === 0 || key.tasks.some((task) => tasks.includes(task))));
    block.classList.toggle('idle', !used && !state.given[group]);
    const n = Object.keys(state.given[group] ?? {}).length;
    block.querySelector('.groupnote').textContent = !used ? 'for other tasks' : block.open || n === 0 ? '' : `${n} given`;
    refreshMore(block);
  }
  showError(state.error);
}

function refreshMore(block) {
  const hidden = block.querySelectorAll('.field:not(.first)').length, more = block.querySelector('.more');
  more.hidden = hidden === 0;
  more.textContent = block.classList.contains('all') ? 'Fewer keys' : `${hidden} more ${hidden === 1 ? 'key' : 'keys'}`;
  more.setAttribute('aria-expanded', String(block.classList.contains('all')));
}

/** The library's message next to the field that it names, or at its group. */
export function showError(error) {
  for (const node of document.querySelectorAll('#groups .error')) node.hidden = true;
  if (!error) return;
  const field = fields.get(idOf(error.group, error.key));
  const place = field ? field.error : byId(`error.${error.group}`);
  if (!place) return;
  place.textContent = error.message;
  place.hidden = false;
  if (field) {
    field.input.setAttribute('aria-invalid', 'true');
    field.row.classList.add('first');
  }
  place.closest('details').open = true;
}

function find() {
  const wanted = byId('find').value.trim().toLowerCase().replace(/[&=]/g, ' ').split(/\s+/).filter(Boolean);
  byId('groups').classList.toggle('finding', wanted.length > 0);
  const has = (words) => wanted.length > 0 && wanted.every((one) => words.toLowerCase().includes(one));
  const named = (key) => has(`${key.group} ${NAMES[key.group] ?? ''} ${key.name} ${title(key.name, key.unit)}`);
  const all = [...fields.values()], isNamed = all.some(({ key }) => named(key));
  // What is named so; what only speaks of it where nothing is.
  for (const { key, row } of all) row.classList.toggle('found', isNamed ? named(key) : has(key.meaning));
  for (const block of document.querySelectorAll('#groups details')) {
    const n = block.querySelectorAll('.found').length;
    block.classList.toggle('found', n > 0);
    if (wanted.length && n) block.open = true;
  }
}

/** Brings a group into sight. */
export function showGroup(group) {
  const block = byId(`group.${group}`);
  if (!block) return;
  block.open = true;
  block.scrollIntoView({ block: 'start' });
}

/** Takes the hand to a field. */
export function goTo(group, key) {
  const field = fields.get(idOf(group, key));
  if (!field) return;
  field.row.closest('details').open = true;
  field.row.classList.add('first');
  field.input.focus();
}
