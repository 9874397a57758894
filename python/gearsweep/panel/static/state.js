// What this window holds: the case, its past, results and what is looked at. A reload brings it back; no other window sees it.

export const state = {
  text: '', opened: '', place: '', name: 'case', given: {}, values: {}, unused: [], error: null,
  past: [], future: [],
  study: null,      // the present results: name of the study, tables, report, columns that are here
  isStale: false,   // the case has changed since
  kept: [],         // results with names: {name, text, place, isShown, study}
  tab: 'pictures', picture: 'sweep', chosen: {}, own: {}, table: '',
};

const KEPT = ['text', 'opened', 'place', 'name', 'past', 'future', 'tab', 'picture', 'own', 'table'];

/** Keeps what a reload of this window is to bring back; results are computed again. */
export function remember() {
  const words = Object.fromEntries(KEPT.map((name) => [name, state[name]]));
  words.kept = state.kept.map(({ name, text, place, isShown }) => ({ name, text, place, isShown }));
  try {
    sessionStorage.setItem('gearsweep', JSON.stringify(words));
  } catch { /* full, or not allowed: then a reload begins anew */ }
}

/** What was kept by this window, into the state; false where there is nothing. */
export function recall() {
  try {
    const words = JSON.parse(sessionStorage.getItem('gearsweep'));
    if (!words?.text) return false;
    for (const name of KEPT) if (name in words) state[name] = words[name];
    state.kept = words.kept.map((one) => ({ ...one, study: null }));
    return true;
  } catch {
    return false;
  }
}

/** A case takes the place of the present one, which can be had back by undo. */
export function put({ text, place = state.place, name = state.name }) {
  if (text !== state.text || place !== state.place) {
    state.past.push({ text: state.text, place: state.place, name: state.name });
    if (state.past.length > 200) state.past.shift();
    state.future = [];
  }
  Object.assign(state, { text, place, name });
}

/** One step back, or forth; false where there is none. */
export function step(from, to) {
  const found = from.pop();
  if (!found) return false;
  to.push({ text: state.text, place: state.place, name: state.name });
  Object.assign(state, found);
  return true;
}

/** The tables of a study by their names. */
export const tablesOf = (study) => Object.fromEntries(study.tables.map((table) => [table.name, table]));
