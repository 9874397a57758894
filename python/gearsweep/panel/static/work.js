// Runs: of the whole case, and of what is looked at while a slider moves. At most one at a time; the next begins from the last.
import { call, run } from './api.js';
import { columnsOf } from './pictures.js';
import { byId } from './util.js';
import { state, tablesOf } from './state.js';
import { setLoads, setScene } from './teeth.js';

const ONCE = ['motion', 'optimum'];
let running = null, again = null, seconds = 0, shape = null, spare = '';
let hooks = {};

/** `onresult()` is called at new results, `onstate()` at the progress of a run; `picture()` is the one that is looked at. */
export function begin(found) { hooks = found; }

export const isRunning = () => running !== null;
/** Short enough to be run after each change. */
export const isQuick = () => seconds < 3;

/** What decides how the teeth look, as text. */
const shapeOf = () => JSON.stringify([state.place, state.given.pair, state.given.pinion, state.given.gear, state.given.mesh?.contact_ratio]);

function wantedColumns() {
  const found = Object.fromEntries(ONCE.map((name) => [name, null]));
  found.mesh = ['relief_um', 's', 'load_share'];
  found.load = ['relief_um', 'rpm', 's', 'pair', 'pair_load_n'];
  const before = state.study ? tablesOf(state.study) : null;
  const picture = hooks.picture();
  // Before the first run, no table is known: the usual names, of which the server gives those that there are.
  const guessed = () => ({ [picture.table]: [picture.x, picture.y, picture.z, picture.first, 'relief_um', 'rpm'].flat().filter(Boolean), ...picture.needs });
  const known = !picture?.table ? {} : before ? columnsOf(picture, before) : guessed();
  for (const [name, columns] of Object.entries(known)) {
    found[name] = columns === null || found[name] === null ? null : [...new Set([...(found[name] ?? []), ...columns])];
  }
  return found;
}

/** Runs the case, or these of its tasks. Where one runs already, it comes after it; of several only the last. */
export async function calculate(tasks = null) {
  if (running) { again = { tasks }; return; }
  const id = Math.random().toString(36).slice(2);
  running = { id, tasks };
  hooks.onstate();
  const looks = shapeOf(), began = performance.now();
  const text = state.text;
  try {
    const found = await run({
      text, place: state.place, tasks, earlier: state.study?.study ?? '', drop: spare,
      columns: wantedColumns(), teeth: looks !== shape, run: id,
    }, (done, of) => { running.done = done; running.of = of; hooks.onstate(); });
    take(found, tasks, text);
    if (looks !== shape) { setScene(found.scene ?? null); shape = looks; }
    if (!tasks) seconds = (performance.now() - began) / 1000;
    state.error = null;
  } catch (failure) {
    if (!failure.error) throw failure;
    if (failure.error.code !== 'LOST') state.error = failure.error.code === 'INTERRUPTED' ? null : failure.error;
    state.isStale = true;
    hooks.onfailure(failure.error);
  } finally {
    running = null;
    hooks.onstate();
  }
  if (again) {
    const next = again;
    again = null;
    await calculate(next.tasks);
  }
}

const isKept = (name) => Boolean(name) && state.kept.some((one) => one.study?.study === name);

function take(found, tasks, text) {
  // The view may still be at work with the last; the one before it is of no more use.
  spare = isKept(state.study?.study) ? '' : state.study?.study ?? '';
  state.study = { ...found, text, place: state.place };
  state.isStale = Boolean(tasks) || text !== state.text;
  setLoads(loadsOf(state.study));
  hooks.onresult(Boolean(tasks));
}

/** Ends the run that is under way, and forgets what would come after it. */
export async function cancel() {
  again = null;
  if (running) await call('stop', { run: running.id });
}

export const progress = () => running;

/** Fetches columns of tables that are not here yet; a study that is gone is run again first. */
export async function need(study, columns) {
  for (const [name, wanted] of Object.entries(columns)) {
    const table = tablesOf(study)[name];
    if (!table) continue;
    const all = wanted ?? table.columns.map((one) => one.name), here = study.columns[name] ?? {};
    const lacking = all.filter((one) => !(one in here));
    if (lacking.length === 0) continue;
    study.columns[name] = { ...study.columns[name], ...await fetched(study, name, lacking) };
  }
  return study.columns;
}

async function fetched(study, table, columns) {
  try {
    return await call('table', { study: study.study, table, columns });
  } catch (failure) {
    if (failure.error?.code !== 'GONE') throw failure;
    study.study = (await run({ text: study.text, place: study.place })).study;
    return call('table', { study: study.study, table, columns });
  }
}

/** Has the server make a file of a study, and the browser save it. */
export async function file(what, study, name, table = '') {
  await fetched(study, study.tables[0].name, []);
  window.location.href = `/file/${what}?${new URLSearchParams({ study: study.study, name, table })}`;
}

/** What can be shown as the load on the teeth: the static one and those of the speeds, of each relief. */
export function loadings(study) {
  const found = [], data = study.columns;
  const reliefs = data.mesh ? [...new Set(data.mesh.relief_um)] : [];
  for (const relief of reliefs) found.push({ name: `static, relief ${relief} µm`, relief });
  if (data.load) for (const rpm of new Set(data.load.rpm)) for (const relief of new Set(data.load.relief_um)) found.push({ name: `at ${rpm} 1/min, relief ${relief} µm`, relief, rpm });
  return found;
}

let loading = '';
export function choose(name) {
  loading = name;
  if (state.study) setLoads(loadsOf(state.study));
}

function loadsOf(study) {
  const all = loadings(study), picked = byId('loading');
  const best = study.columns.optimum?.relief_um?.[0];
  const one = all.find((item) => item.name === loading) ?? all.find((item) => !item.rpm && item.relief === 0) ?? all[0];
  picked.replaceChildren(...all.map((item) => { const option = document.createElement('option'); option.textContent = item.name; return option; }));
  picked.value = one?.name ?? '';
  picked.parentNode.hidden = all.length === 0;
  if (!one) return null;
  const force = study.columns.motion?.load_n?.[0] ?? 1, isStatic = one.rpm === undefined;
  const from = isStatic ? study.columns.mesh : study.columns.load, s = [], load = [];
  from.s.forEach((place, i) => {
    if (from.relief_um[i] !== one.relief || (!isStatic && (from.rpm[i] !== one.rpm || from.pair[i] !== 1))) return;
    s.push(place);
    load.push(isStatic ? from.load_share[i] * force : from.pair_load_n[i] ?? 0);
  });
  return { s, load, largest: force, unit: 'N', best };
}
