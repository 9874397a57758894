// A tour for the first time: a few steps, each next to its subject.
import { byId, el } from './util.js';
import { state } from './state.js';

const STEPS = [
  { at: '#cases', words: 'A case is a gear pair with what is to be computed. This is case 1 of Dogan, Kalay and Karpat (2021): two gears of 25 teeth. Other papers’ cases, and those of your folder, are in this list.', before: (does) => does.open('case1.nml') },
  { at: '#groups', words: 'Each key of the case is a field. Go into one: a line below tells what it means and what is allowed, and a slider changes it. What cannot be is said at once, in red, next to the field.' },
  { at: '#pair', words: 'The pair turns through its mesh. Red arrows are the loads of the pairs in contact, blue the line of action with A, B, P, D and E. Choose below whether the load is the static one or that of the motion.' },
  { at: '#view', words: 'Largest load on one pair over the static load, the dynamic factor DF, over the speed: a curve for each relief. Without relief it reaches 1.48 in the resonance; with 15 µm it stays at 1.03.', tab: 'pictures', picture: 'sweep' },
  { at: '#view', words: 'The optimum: of all reliefs the one whose largest DF over all speeds is least. The least point of this curve is the relief to take.', tab: 'pictures', picture: 'optimum' },
  { at: '#field\\.relief\\.amount_um', words: 'Try it: put the caret on the last number of the reliefs and move the slider. The curves follow.', tab: 'pictures', picture: 'sweep', focus: ['relief', 'amount_um'] },
  { at: '#tab\\.compare', words: 'Keep results by a name before you change more: both are then shown side by side here and in the pictures. Undo takes back any change.', tab: 'compare' },
  { at: '#tab\\.answer', words: 'The whole answer as text, a report for the browser, and all tables and pictures as files. That is all: what you had before comes back now.', tab: 'answer' },
];

export function tour(does) {
  const guide = byId('guide'), from = document.activeElement;
  let at = 0, marked = null, opening = null;
  const unmark = () => marked?.classList.remove('toured');
  const end = () => { unmark(); guide.hidden = true; document.removeEventListener('keydown', keys); Promise.resolve(opening).finally(does.back); from?.focus(); };
  const keys = (event) => { if (event.key === 'Escape') end(); };
  const show = () => {
    const step = STEPS[at];
    if (step.picture) state.picture = step.picture;
    if (step.tab) does.view.go(step.tab);
    if (step.focus) does.form.goTo(...step.focus);
    unmark();
    marked = document.querySelector(step.at);
    marked?.classList.add('toured');
    marked?.scrollIntoView({ block: 'nearest' });
    const next = el('button', { type: 'button', className: 'strong', onclick: () => { if (++at < STEPS.length) show(); else end(); } }, at < STEPS.length - 1 ? 'Next' : 'Done');
    guide.replaceChildren(el('p', {}, step.words), el('div', { className: 'bar' }, el('span', {}, `${at + 1} of ${STEPS.length}`), el('span', { className: 'gap' }),
      el('button', { type: 'button', onclick: end }, 'End'), at > 0 ? el('button', { type: 'button', onclick: () => { at--; show(); } }, 'Back') : null, next));
    guide.classList.toggle('left', Boolean(marked?.closest('#results')));
    guide.hidden = false;
    if (!step.focus) next.focus();
    opening = step.before?.(does) ?? opening;
  };
  document.addEventListener('keydown', keys);
  show();
}
