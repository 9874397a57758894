// Compares results that are kept by name: differences of the cases and of their results.
import { el, labelled, shown } from './util.js';
import { remember, tablesOf } from './state.js';
import { need } from './work.js';
import { call, run } from './api.js';

const RESULTS = ['geometry', 'motion', 'sweep_summary', 'optimum', 'transmission_error', 'sweep_worst', 'root_stress', 'root_rating', 'modal'];

export async function compare(place, state, about, does, refresh) {
  const again = () => { remember(); compare(place, state, about, does, refresh).catch(does.showError); };
  const input = el('input', { type: 'text', id: 'keepname', 'aria-label': 'Name', placeholder: `${state.name} ${state.kept.length + 1}` });
  const keep = (event) => {
    event.preventDefault();
    const name = input.value.trim() || input.placeholder;
    state.kept = [...state.kept.filter((one) => one.name !== name), { name, text: state.study.text, place: state.study.place, isShown: true, study: state.study }];
    again();
  };
  const bar = el('form', { className: 'bar', onsubmit: keep }, el('label', { for: 'keepname' }, 'Keep these results as'), input, el('button', { type: 'submit' }, 'Keep'));
  for (const one of state.kept) {
    if (!one.study) one.study = { ...(await run({ text: one.text, place: one.place })), text: one.text, place: one.place };
  }
  const list = el('ul', { className: 'kept' }, ...state.kept.map((one) => el('li', {},
    el('label', { title: 'Show it in the pictures, too' }, el('input', { type: 'checkbox', checked: one.isShown, onchange: (event) => { one.isShown = event.target.checked; again(); } }), ` ${one.name}`),
    el('button', { type: 'button', onclick: () => does.show(one.text, one.place, one.name).catch(does.showError), title: 'Its case becomes the present one' }, 'Take its case'),
    el('button', { type: 'button', 'aria-label': `Forget ${one.name}`, onclick: () => { state.kept = state.kept.filter((other) => other !== one); again(); } }, 'Forget'))));
  const shown_ = [{ name: 'now', study: state.study, text: state.study.text, place: state.study.place }, ...state.kept.filter((one) => one.isShown)];
  place.replaceChildren(bar, state.kept.length ? list : el('p', { className: 'hint shown' }, 'Keep results by a name, change the case, and both are shown side by side here and in the pictures.'),
    ...(shown_.length > 1 ? [el('div', { className: 'scroll', tabIndex: 0 }, await sheet(shown_, about))] : []));
}

async function sheet(all, about) {
  const lines = [];
  for (const one of all) one.given = (await call('check', { text: one.text, place: one.place ?? '' })).given;
  for (const key of about.keys) {
    const words = all.map((one) => one.given[key.group]?.[key.name] ?? '');
    if (key.name !== 'title' && new Set(words).size > 1) lines.push(el('tr', {}, el('th', { scope: 'row', title: key.meaning }, `&${key.group} ${key.name}`), ...words.map((word) => el('td', { className: 'number' }, word || '(default)'))));
  }
  const heading = (words) => el('tr', { className: 'part' }, el('th', { colSpan: all.length + 1 }, words));
  const results = [];
  for (const name of RESULTS) results.push(...await linesOf(name, all));
  const head = el('tr', {}, el('th', {}), ...all.map((one) => el('th', { scope: 'col', className: 'number' }, one.name)));
  return el('table', { className: 'compare' }, el('thead', {}, head), el('tbody', {}, heading(lines.length ? 'What differs in the cases' : 'The cases are the same'), ...lines, heading('What they give'), ...results));
}

/** The columns of a table with few rows; only what differs somewhere. */
async function linesOf(name, all) {
  const found = [], tables = all.map((one) => tablesOf(one.study)[name]);
  const first = tables.find(Boolean);
  if (!first || Math.max(...tables.map((table) => table?.rows ?? 0)) > 12) return found;
  const data = [];
  for (const [i, one] of all.entries()) data.push(tables[i] ? (await need(one.study, { [name]: null }))[name] : null);
  const index = first.columns.filter((one) => one.index);
  const keyOf = (columns, row) => index.map((one) => `${labelled(one)} ${shown(columns[one.name][row])}`).join(', ');
  const keys = [...new Set(data.flatMap((columns, i) => columns ? Array.from({ length: tables[i].rows }, (_, row) => keyOf(columns, row)) : []))];
  for (const column of first.columns.filter((one) => !one.index)) for (const key of keys) {
    const values = data.map((columns, i) => {
      if (!columns || !(column.name in columns)) return null;
      const row = Array.from({ length: tables[i].rows }, (_, at) => at).find((at) => keyOf(columns, at) === key);
      return row === undefined ? null : columns[column.name][row];
    });
    if (new Set(values.map((value) => shown(value, 6))).size < 2) continue;
    found.push(el('tr', {}, el('th', { scope: 'row', title: column.meaning }, labelled(column), el('small', {}, ` ${name}${key ? ', ' + key : ''}`)), ...values.map((value) => el('td', { className: 'number' }, shown(value, 5)))));
  }
  return found;
}
