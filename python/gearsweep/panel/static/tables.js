// Tables as they are: all columns with units and meanings, a page of rows at a time, and the file.
import { el, labelled, shown } from './util.js';
import { remember, tablesOf } from './state.js';
import { file, need } from './work.js';

const PAGE = 100;
let from = 0;

export async function tables(place, state, showError) {
  const there = tablesOf(state.study), names = Object.keys(there);
  if (!(state.table in there)) state.table = ['sweep_worst', 'sweep', 'mesh'].find((one) => one in there) ?? names[0];
  const table = there[state.table], again = () => tables(place, state, showError).catch(showError);
  const select = el('select', { id: 'table', 'aria-label': 'Table', onchange: () => { state.table = select.value; from = 0; remember(); again(); } }, ...names.map((name) => el('option', { value: name }, name)));
  select.value = table.name;
  const study = state.study, data = (await need(study, { [table.name]: null }))[table.name];
  if (study !== state.study) return;
  if (from >= table.rows) from = 0;
  const to = Math.min(table.rows, from + PAGE);
  const move = (by) => () => { from = Math.max(0, from + by); again(); };
  const bar = el('div', { className: 'bar' }, select, el('span', { className: 'gap' }),
    ...(table.rows > PAGE ? [el('button', { type: 'button', onclick: move(-PAGE), disabled: from === 0, 'aria-label': 'Rows before' }, '‹'),
      el('span', {}, `rows ${from + 1} to ${to} of ${table.rows}`), el('button', { type: 'button', onclick: move(PAGE), disabled: to === table.rows, 'aria-label': 'Rows behind' }, '›')] : []),
    el('button', { type: 'button', onclick: () => file('table', study, state.name, table.name).catch(showError) }, 'CSV'));
  place.replaceChildren(bar, el('p', { className: 'hint shown' }, `${table.meaning.charAt(0).toUpperCase()}${table.meaning.slice(1)}.`), el('div', { className: 'scroll', tabIndex: 0 }, table.rows === 1 ? upright(table, data) : rows(table, data, to)));
}

const cell = (value) => el('td', { className: typeof value === 'string' ? '' : 'number' }, shown(value, 6));

function rows(table, data, to) {
  const head = table.columns.map((one) => el('th', { title: one.meaning, scope: 'col', className: one.kind === 'text' ? '' : 'number' }, labelled(one)));
  const body = [];
  for (let i = from; i < to; i++) body.push(el('tr', {}, ...table.columns.map((one) => cell(data[one.name][i]))));
  return el('table', {}, el('thead', {}, el('tr', {}, ...head)), el('tbody', {}, ...body));
}

/** Of a table of one row, the columns stand below each other. */
function upright(table, data) {
  return el('table', {}, el('tbody', {}, ...table.columns.map((one) => el('tr', {}, el('th', { scope: 'row' }, labelled(one)), cell(data[one.name][0]), el('td', { className: 'meaning' }, one.meaning)))));
}
