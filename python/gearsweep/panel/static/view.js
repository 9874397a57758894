// The right side: numbers at a glance, and tabs for pictures, tables, the answer, comparisons and the case's text.
import { byId, download, el, labelled, shown, title, unit } from './util.js';
import { chart, markOf, nearest, readoutOf } from './chart.js';
import { PICTURES, withKept, byName, columnsOf, drawn, isBody, isThere, own } from './pictures.js';
import { bodyOf, stopBody } from './body.js';
import { remember, state, tablesOf } from './state.js';
import { file, need } from './work.js';
import { compare } from './compare.js';
import { tables } from './tables.js';
import { save } from './export.js';
import { goTo } from './form.js';

const TABS = [['pictures', 'Pictures'], ['tables', 'Tables'], ['answer', 'Answer'], ['compare', 'Compare'], ['text', 'Case']];
let about = null, does = null;

/** `does` has what the view asks for: `change` of a key, `show` of a case, `showError` of failures. */
export function begin(description, found) {
  about = description;
  does = found;
  byId('tabs').append(...TABS.map(([id, name]) => el('button', { type: 'button', role: 'tab', id: `tab.${id}`, 'aria-controls': 'view', onclick: () => go(id) }, name)));
  byId('tabs').addEventListener('keydown', (event) => {
    const at = TABS.findIndex(([id]) => id === state.tab), by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    go(TABS[(at + by + TABS.length) % TABS.length][0]);
    byId(`tab.${state.tab}`).focus();
  });
  let wide = 0;
  new ResizeObserver(() => { const now = byId('view').clientWidth; if (Math.abs(now - wide) > 2) { wide = now; if (state.tab === 'pictures') refresh(); } }).observe(byId('view'));
}

export function go(tab) {
  state.tab = tab;
  remember();
  refresh();
}

/** The picture that is looked at; null where another tab is open. */
export const picture = () => (state.tab === 'pictures' ? present() : null);

function present() {
  if (state.picture !== 'own') return byName(state.picture) ?? PICTURES[0];
  return own(state.own.table, state.own.x, state.own.y);
}

/** Of a case that was opened, a picture that there is. */
export function pickPicture() {
  if (!state.study || isThere(present(), tablesOf(state.study))) return;
  state.picture = PICTURES.find((one) => isThere(one, tablesOf(state.study)))?.id ?? 'own';
  remember();
  refresh();
}

/** The picture of a task that was asked for, once there is one. */
let awaited = null;
export function awaitPicture(task) { awaited = task; }

function pickAwaited() {
  const there = tablesOf(state.study), one = PICTURES.find((picture) => taskOf(picture) === awaited && isThere(picture, there));
  if (!one) return;
  awaited = null;
  Object.assign(state, { picture: one.id, chosen: {}, tab: 'pictures' });
  remember();
}

function lookAt(id) {
  state.picture = id;
  state.chosen = {};
  state.tab = 'pictures';
  remember();
  refresh().then(() => byId('picture')?.focus());
}

/** Draws anew what is open. */
export function refresh(isSliding = false) {
  if (awaited && state.study) pickAwaited();
  for (const [id] of TABS) {
    const tab = byId(`tab.${id}`), isOpen = id === state.tab;
    tab.setAttribute('aria-selected', String(isOpen));
    tab.tabIndex = isOpen ? 0 : -1;
  }
  byId('view').setAttribute('aria-labelledby', `tab.${state.tab}`);
  if (state.tab !== 'pictures') stopBody();
  numbers();
  const place = byId('view');
  if (!state.study) {
    place.replaceChildren(state.tab === 'text' ? textTab() : el('p', { className: 'empty' }, 'There are no results yet.'));
    return Promise.resolve();
  }
  const shows = { pictures: () => pictureTab(isSliding), tables: () => tables(place, state, does.showError), answer: answerTab, compare: () => compare(place, state, about, does, refresh), text: () => place.replaceChildren(textTab()) };
  return Promise.resolve(shows[state.tab]()).catch(does.showError);
}

/** The numbers that the server picked of each task; each leads to the picture that shows it. */
function numbers() {
  byId('numbers').replaceChildren(...(state.study?.headlines ?? []).map((one) => el('div', { className: one.more.length > 60 ? 'long' : '' }, el('dt', {}, one.name), el('dd', {},
    el('button', { type: 'button', title: byName(one.picture)?.title ?? '', onclick: () => lookAt(one.picture) }, el('b', {}, one.value)), el('small', {}, one.more)))));
}

// --- pictures -------------------------------------------------------------------

const taskOf = (one) => one.task ?? about.tasks.find((task) => task.tables.includes(one.table))?.name;

/** What these results lack for a picture, in words. */
const askOf = (one, there) => (one.table in there ? `&${one.set[0]} ${one.set[1]} = ${/^[a-z]/.test(one.set[2]) ? `'${one.set[2]}'` : one.set[2]}` : `task ${taskOf(one)}`);

function picker(there) {
  const options = PICTURES.map((one) => el('option', { value: one.id }, isThere(one, there) ? one.title : `${one.title} (${askOf(one, there)})`));
  const here = options.filter((one) => isThere(byName(one.value), there)), elsewhere = options.filter((one) => !isThere(byName(one.value), there));
  const select = el('select', { id: 'picture', 'aria-label': 'Picture' }, el('optgroup', { label: 'Of these results' }, ...here, el('option', { value: 'own' }, 'Any column over another …')),
    elsewhere.length ? el('optgroup', { label: 'With another task' }, ...elsewhere) : null);
  select.value = state.picture;
  select.addEventListener('change', () => {
    state.picture = select.value;
    state.chosen = {};
    if (state.picture === 'own' && !state.own.table) state.own = firstOwn(there);
    remember();
    refresh().then(() => byId('picture')?.focus());
  });
  return select;
}

function firstOwn(there) {
  const numbers = (one) => one.columns.filter((column) => column.kind !== 'text');
  const all = Object.values(there).filter((one) => one.rows > 1 && numbers(one).length > 1);
  return axesOf(all.find((one) => one.rows > 5 && numbers(one).some((column) => column.index)) ?? all[0]);
}

function axesOf(table) {
  const numbers = table.columns.filter((one) => one.kind !== 'text');
  const index = numbers.filter((one) => one.index), values = numbers.filter((one) => !one.index);
  return { table: table.name, x: (index[index.length - 1] ?? numbers[0]).name, y: (values[0] ?? numbers[numbers.length - 1]).name };
}

function ownPicker(there) {
  const select = (name, options, value, onchange) => {
    const node = el('select', { onchange: () => { onchange(node.value); remember(); refresh(); } }, ...options.map(([id, words]) => el('option', { value: id }, words)));
    node.value = value;
    return el('label', {}, `${name} `, node);
  };
  const table = there[state.own.table], columns = table.columns.filter((one) => one.kind !== 'text').map((one) => [one.name, labelled(one)]);
  return [
    select('Table', Object.values(there).filter((one) => one.rows > 1).map((one) => [one.name, one.name]), table.name, (value) => { state.own = axesOf(there[value]); state.chosen = {}; }),
    select('over', columns, state.own.x, (value) => { state.own.x = value; }),
    select('is drawn', columns, state.own.y, (value) => { state.own.y = value; }),
  ];
}

async function pictureTab(isSliding) {
  const place = byId('view'), there = tablesOf(state.study);
  if (state.picture === 'own' && !(state.own.table in there)) state.own = firstOwn(there);
  const one = present(), bar = el('div', { className: 'bar' }, picker(there), ...(state.picture === 'own' ? ownPicker(there) : []));
  if (!isThere(one, there)) {
    stopBody();
    const task = taskOf(one);
    const asked = (state.values.case?.tasks ?? '').match(/\w+/g) ?? [];
    const add = el('button', { type: 'button', onclick: () => addTask(one, task, asked) }, asked.includes(task) ? `Compute it${one.table in there ? `, with ${askOf(one, there)}` : ''}` : `Compute ${task}, too`);
    place.replaceChildren(bar, el('p', { className: 'empty' }, `This picture is of the task ${task}: ${about.tasks.find((found) => found.name === task)?.meaning ?? ''}.`), add);
    return;
  }
  if (isBody(one)) {
    await bodyOf(place, bar, one, state, need, save);
    return;
  }
  stopBody();
  const study = state.study, data = await need(study, columnsOf(one, there));
  if (study !== state.study) return;
  if (there[one.table].rows === 0) { place.replaceChildren(bar, el('p', { className: 'empty' }, 'This table has no rows: there is nothing to draw.')); return; }
  let spec = drawn(one, there, data, state.chosen);
  if (!isSliding || state.kept.some((kept) => kept.isShown)) spec = withKept(spec, await others(one));
  show(place, bar, spec, one);
}

/** The same picture of each kept result that is shown and has its table. */
async function others(one) {
  const found = [];
  for (const kept of state.kept.filter((item) => item.isShown && item.study)) {
    const there = tablesOf(kept.study);
    if (!(one.table in there)) continue;
    const data = await need(kept.study, columnsOf(one, there));
    try { found.push({ name: kept.name, spec: drawn(one, there, data, state.chosen) }); } catch { /* another shape of table */ }
  }
  return found;
}

async function addTask(one, task, asked) {
  if (one.set && (one.table in tablesOf(state.study) || !state.given[one.set[0]]?.[one.set[1]])) await does.change(...one.set);
  if (!asked.includes(task)) await does.change('case', 'tasks', [...asked, task].map((word) => `'${word}'`).join(', '));
  if (state.error?.key) goTo(state.error.group, state.error.key);
  else if (state.isStale && !state.error) await does.calculate();
}

function show(place, bar, spec, one) {
  const wide = Math.max(300, place.clientWidth - 2), tall = Math.max(260, Math.min(460, Math.round(wide * 0.5), window.innerHeight - place.getBoundingClientRect().top - 110));
  const drawing = chart(spec, wide, tall);
  for (const family of spec.families ?? []) {
    const select = el('select', { onchange: () => { state.chosen[family.name] = family.values[select.selectedIndex]; refresh(); } },
      ...family.values.map((value) => el('option', {}, `${shown(value)}${family.unit ? ' ' + unit(family.unit) : ''}`)));
    select.selectedIndex = Math.max(0, family.values.indexOf(family.value));
    bar.append(el('label', {}, `${title(family.name, family.unit)} `, select));
  }
  bar.append(el('span', { className: 'gap' }), el('button', { type: 'button', onclick: () => save('svg', drawing, name(one)) }, 'SVG'), el('button', { type: 'button', onclick: () => save('png', drawing, name(one)) }, 'PNG'));
  const readout = el('p', { className: 'readout', role: 'status', 'aria-live': 'polite' }, `${spec.below ?? ''} Point at a curve, or walk along it by the arrow keys.`.trim());
  // On paper there is no list to read the picture's name from.
  place.replaceChildren(bar, el('p', { className: 'printed' }, spec.title), legend(spec), drawing, readout);
  place.dataset.picture = one.id;
  follow(drawing, readout);
}

const name = (one) => `${state.name}.${one.id}`;

function legend(spec) {
  const entries = spec.series.filter((one) => one.label).map((one) => {
    const key = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    key.setAttribute('width', 30);
    key.setAttribute('height', 10);
    key.innerHTML = spec.kind === 'bars' ? '<rect x="8" y="0" width="14" height="10"/>' : spec.kind === 'points' && one.kind !== 'line' ? `<path d="M15 5${markOf(one, 3.5)}"/>` : `<line x1="0" x2="30" y1="5" y2="5" stroke-dasharray="${one.dash}" stroke-width="${one.width ?? 2}"/>${one.kept ? '<circle cx="15" cy="5" r="3"/>' : ''}`;
    key.style.stroke = key.style.fill = one.color;
    return el('li', {}, key, one.label);
  });
  return el('ul', { className: 'legend' }, ...entries);
}

/** Says what is under the pointer, or under the place that the arrow keys lead to. */
function follow(drawing, readout) {
  const { spec } = drawing.places;
  const ring = document.createElementNS('http://www.w3.org/2000/svg', 'circle');
  ring.setAttribute('r', 5);
  ring.setAttribute('class', 'ring');
  ring.setAttribute('visibility', 'hidden');
  drawing.append(ring);
  let at = null;
  // The curve at hand stands out from the others.
  const tell = (s) => { for (const one of drawing.querySelectorAll('.curve')) one.classList.toggle('dim', s !== null && s !== undefined && Number(one.dataset.series) !== s); };
  drawing.addEventListener('pointerleave', () => tell(null));
  drawing.addEventListener('blur', () => tell(null));
  const mark = (found) => {
    at = found;
    if (!found) return;
    readout.textContent = readoutOf(spec, found);
    ring.setAttribute('cx', found.px);
    ring.setAttribute('cy', found.py);
    ring.setAttribute('visibility', 'visible');
    tell(spec.series.length > 1 ? found.s : null);
  };
  drawing.addEventListener('pointermove', (event) => { const box = drawing.getBoundingClientRect(); mark(nearest(drawing, event.clientX - box.left, event.clientY - box.top)); });
  drawing.addEventListener('keydown', (event) => {
    const step = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!step) return;
    event.preventDefault();
    if (spec.map || !at) { const { width, height } = drawing.places; mark(nearest(drawing, (at?.px ?? width / 2) + 12 * step[0], (at?.py ?? height / 2) + 12 * step[1])); return; }
    if (spec.words) { mark(nearest(drawing, 0, drawing.places.y(at.i + step[0] + step[1]))); return; }
    const n = spec.series.length, s = (at.s + step[1] + n) % n, series = spec.series[s];
    const i = Math.min(series.x.length - 1, Math.max(0, at.i + step[0]));
    if (series.y[i] === null || series.x[i] === null) { at = { ...at, s, i }; readout.textContent = `${series.label || spec.ylabel}: no answer at ${spec.xlabel} ${shown(series.x[i])}`; return; }
    mark({ x: series.x[i], y: series.y[i], s, i, label: series.label, note: series.notes?.[i], px: drawing.places.x(series.x[i]), py: drawing.places.y(series.y[i]) });
  });
}

// --- answer and text --------------------------------------------------------------

function answerTab() {
  const make = (what) => () => file(what, state.study, state.name).catch(does.showError);
  byId('view').replaceChildren(
    el('div', { className: 'bar' }, el('button', { type: 'button', onclick: () => download(`${state.name}.txt`, state.study.report) }, 'Text'),
      el('button', { type: 'button', onclick: make('report'), title: 'One page with the answer, pictures, small tables and the case' }, 'Report (HTML)'),
      el('button', { type: 'button', onclick: make('all'), title: 'Case, answer, report, all tables as CSV and pictures as PNG and SVG' }, 'Everything (ZIP)')),
    state.study.partial ? el('p', { className: 'note' }, state.study.partial) : '',
    el('pre', { id: 'answer', tabIndex: 0 }, state.study.report));
}

function textTab() {
  const area = el('textarea', { id: 'text', spellcheck: false, 'aria-label': 'The case as text', value: state.text });
  const take = () => does.show(area.value, state.place, state.name).catch(does.showError);
  const unused = state.unused.length ? el('p', { className: 'note' }, `Set, but not used: ${state.unused.join('; ')}.`) : null;
  return el('div', {}, el('div', { className: 'bar' }, el('button', { type: 'button', onclick: take }, 'Take this text'), el('button', { type: 'button', onclick: () => download(`${state.name}.nml`, area.value) }, 'Save')),
    el('p', { className: 'hint shown' }, 'The same text as everywhere: for the program, Python and Fortran.'), unused, area);
}
