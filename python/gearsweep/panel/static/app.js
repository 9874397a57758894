// The panel's page: from what is typed to what is shown.
import { call, onReturn } from './api.js';
import * as form from './form.js';
import { begin as beginTeeth, draw } from './teeth.js';
import { byId, download, el, isDark, names } from './util.js';
import { put, recall, remember, state, step } from './state.js';
import * as work from './work.js';
import * as view from './view.js';
import { tour } from './tour.js';

let about = null;
let line = Promise.resolve();

/** What changes the text comes one after the other. */
function inLine(work) {
  line = line.then(work, work);
  return line;
}

/** Takes what the server says of a text, and shows it. */
function take(answer) {
  for (const name of ['given', 'values', 'unused', 'error']) state[name] = answer[name];
  form.refresh(state);
  showState();
  remember();
}

/** A key has another value: the text follows, and with it the results. */
async function change(group, key, value, isSliding = false) {
  const before = tasks();
  const error = await inLine(async () => {
    const answer = await call('change', { text: state.text, place: state.place, group, key, value });
    if (!answer.unchanged && answer.text !== state.text) {
      // The whole way of a slider is one step for undo.
      if (isSliding && change.slid === `${group}.${key}`) state.text = answer.text;
      else put({ text: answer.text });
      state.isStale = true;
    }
    change.slid = isSliding ? `${group}.${key}` : null;
    take(answer);
    return answer.error;
  });
  const added = group === 'case' && key === 'tasks' ? tasks().find((one) => !before.includes(one)) : null;
  if (added) await beginTask(added, error);
  else if (!error) await follow(isSliding);
}

const tasks = () => (state.values.case?.tasks ?? state.given.case?.tasks ?? '').match(/\w+/g) ?? [];

/** A task was ticked: its group comes into sight, or the key that it lacks, and its picture once it is computed. */
async function beginTask(task, error) {
  if (error?.key) form.goTo(error.group, error.key);
  else form.showGroup(task);
  view.awaitPicture(task);
  if (!error) await follow(false);
}

/** What was typed while the server was away is sent when it is back. */
let unsent = null;
function typed(...all) {
  change(...all).then(() => { unsent = null; }, (failure) => {
    if (failure.error?.code === 'LOST') unsent = all;
    showError(failure);
  });
}

/** Slides: while one answer is on its way, only the last of the next counts. */
let sliding = null;
async function slide(group, key, value) {
  const isBusy = sliding !== null;
  sliding = { group, key, value };
  if (isBusy) return;
  while (sliding) {
    const now = sliding, began = performance.now();
    await change(now.group, now.key, now.value, true).catch(showError);
    performance.measure('redraw', { start: began, end: performance.now() });
    if (sliding === now) sliding = null;
  }
}

async function follow(isSliding) {
  if (!byId('auto').checked || !work.isQuick()) return;
  const picture = view.picture();
  const task = picture?.task ?? about.tasks.find((one) => one.tables.includes(picture?.table))?.name;
  const asked = tasks();
  await work.calculate(isSliding && asked.includes(task) ? [...new Set(['mesh', task])].filter((one) => asked.includes(one)) : null);
}

/** A pair of one's own begins with what has no default; masses follow from its gears. */
const NEW = `&case tasks = 'mesh', 'sweep', 'optimum' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 /
&gear teeth = 34 /
&load torque_nm = 100 /
&relief amount_um = 0, 10, 20 /
&mesh model = 'fe' /
&sweep rpm_first = 1000 rpm_last = 20000 rpm_step = 100 /
`;

/** Shows a case that was opened, and computes it. */
async function show(answer, name) {
  state.opened = answer.text;
  put({ text: answer.text, place: answer.place ?? '', name: name ?? answer.name });
  adopt(answer);
  await results();
  view.pickPicture();
}

function adopt(answer) {
  document.activeElement?.blur();
  state.isStale = true;
  take(answer);
  byId('cases').options[0].textContent = state.name;
  byId('cases').value = `${state.place}/${state.name}.nml`;
  if (!byId('cases').value) byId('cases').value = '';
  document.title = `${state.name} – gearsweep`;
}

async function results() {
  if (!state.error) await work.calculate();
  else await view.refresh();
}

const check = () => call('check', { text: state.text, place: state.place });

async function undo(from, to) {
  await inLine(async () => { if (step(from, to)) adopt(await check()); });
  await results();
}

function showState() {
  const place = byId('state'), now = work.progress();
  byId('changed').hidden = state.text === state.opened;
  byId('undo').disabled = state.past.length === 0;
  byId('redo').disabled = state.future.length === 0;
  byId('cancel').hidden = !now;
  byId('calculate').classList.toggle('due', state.isStale && !now && !state.error);
  const bar = byId('progress');
  bar.hidden = !now;
  if (now?.of) { bar.max = now.of; bar.value = now.done; } else bar.removeAttribute('value');
  place.className = state.error ? 'error' : '';
  place.textContent = now ? (now.of ? `${now.done} of ${now.of} points` : 'calculating')
    : state.error ? state.error.message
      : showState.said ? showState.said
        : state.isStale ? 'The results belong to the case before the last change.' : state.study ? `Done in ${(state.study.seconds * 1000).toFixed(0)} ms.` : '';
  byId('results').classList.toggle('stale', state.isStale);
}

function showError(failure) {
  if (!failure.error) throw failure;
  if (failure.error.code !== 'LOST') state.error = failure.error;
  form.showError(state.error);
  showState();
}

function buttons() {
  byId('inputs').addEventListener('submit', (event) => { event.preventDefault(); work.calculate().catch(showError); });
  byId('cancel').addEventListener('click', () => work.cancel().catch(showError));
  byId('undo').addEventListener('click', () => undo(state.past, state.future).catch(showError));
  byId('redo').addEventListener('click', () => undo(state.future, state.past).catch(showError));
  byId('save').addEventListener('click', save);
  byId('new').addEventListener('click', () => openText(NEW, 'new'));
  byId('open').addEventListener('click', () => byId('file').click());
  byId('file').addEventListener('change', async (event) => {
    const [file] = event.target.files;
    if (file) await openText(await file.text(), file.name.replace(/\.[^.]*$/, ''));
    event.target.value = '';
  });
  byId('cases').addEventListener('change', async (event) => {
    const [place, name] = event.target.value.split('/');
    await call('open', { place, name }).then((answer) => show(answer)).catch(showError);
  });
  byId('loading').addEventListener('change', (event) => work.choose(event.target.value));
  byId('tour').addEventListener('click', () => {
    const { text, place, name, opened, picture, tab, chosen } = state, past = [...state.past], future = [...state.future];
    const back = () => call('check', { text, place }).then((answer) => show({ ...answer, place }, name))
      .then(() => { Object.assign(state, { opened, picture, tab, chosen, past, future }); showState(); view.refresh(); }).catch(showError);
    tour({ open: (name) => call('open', { place: 'data', name }).then((answer) => show(answer)), back, view, form });
  });
  byId('toresults').addEventListener('click', () => byId('results').scrollIntoView());
  byId('look').addEventListener('click', look);
  document.addEventListener('dragover', (event) => event.preventDefault());
  document.addEventListener('drop', async (event) => {
    event.preventDefault();
    const [file] = event.dataTransfer.files;
    if (file) await openText(await file.text(), file.name.replace(/\.[^.]*$/, ''));
  });
  document.addEventListener('keydown', keys);
}

/** A case from a file of the browser's, which has no folder. */
async function openText(text, name) {
  const answer = await call('check', { text, place: '' }).catch(showError);
  if (answer) await show({ ...answer, place: '' }, name).catch(showError);
}

const save = () => download(`${state.name}.nml`, state.text);

function keys(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  const key = event.key.toLowerCase(), isText = event.target.matches('input[type=text], input[type=search], textarea');
  const back = key === 'z' && !event.shiftKey, forth = (key === 'z' && event.shiftKey) || key === 'y';
  if (key === 's') save();
  else if (key === 'enter') work.calculate().catch(showError);
  else if (back && !isText) undo(state.past, state.future).catch(showError);
  else if (forth && !isText) undo(state.future, state.past).catch(showError);
  else return;
  event.preventDefault();
}

/** The other of light and dark: for this window. */
function look() {
  const next = isDark() ? 'light' : 'dark';
  document.documentElement.dataset.look = next;
  sessionStorage.setItem('gearsweep-look', next);
  draw();
  view.refresh();
}

function fillCases() {
  const group = (label, place) => {
    const cases = about.cases.filter((one) => one.place === place);
    return cases.length ? [el('optgroup', { label }, ...cases.map((one) => el('option', { value: `${place}/${one.name}` }, one.title || one.name)))] : [];
  };
  byId('cases').append(el('option', { value: '', hidden: true }, 'Choose a case'), ...group('This folder', 'folder'), ...group('Cases of papers', 'data'));
}

async function start() {
  document.documentElement.dataset.look = sessionStorage.getItem('gearsweep-look') ?? '';
  about = await call('about');
  Object.assign(names, about.names);
  fillCases();
  form.build(about, typed, slide);
  buttons();
  beginTeeth();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { draw(); view.refresh(); });
  work.begin({
    picture: view.picture, onstate: () => { if (work.isRunning()) showState.said = ''; showState(); }, onresult: view.refresh,
    onfailure: (failure) => { form.showError(state.error); showState.said = failure.code === 'INTERRUPTED' ? 'Stopped. The results are those of before.' : ''; view.refresh(); },
  });
  onReturn(() => (unsent ? typed(...unsent) : check().then(take).then(results).catch(showError)));
  view.begin(about, { change, calculate: work.calculate, show: (text, place, name) => call('check', { text, place }).then((answer) => show({ ...answer, place }, name)), showError });
  if (recall()) adopt(await check());
  else {
    const answer = await call('open', about.start);
    Object.assign(state, { text: answer.text, opened: answer.text, place: answer.place, name: answer.name });
    adopt(answer);
  }
  await results();
  performance.mark('answer');
}

start().catch(showError);
