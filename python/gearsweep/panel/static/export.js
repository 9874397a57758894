// A drawing as a file: as it is seen, on a light ground.
import { download, svg } from './util.js';

const STYLED = ['fill', 'stroke', 'stroke-width', 'stroke-dasharray', 'font-family', 'font-size', 'font-weight', 'opacity'];

/** A copy of a drawing that stands alone: what the page's style gives it is written into it. */
function alone(drawing) {
  const copy = drawing.cloneNode(true);
  const from = [drawing, ...drawing.querySelectorAll('*')], to = [copy, ...copy.querySelectorAll('*')];
  from.forEach((node, i) => {
    const style = getComputedStyle(node);
    for (const name of STYLED) to[i].setAttribute(name, style.getPropertyValue(name));
    to[i].removeAttribute('class');
  });
  copy.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
  copy.prepend(svg('rect', { width: '100%', height: '100%', fill: getComputedStyle(document.documentElement).getPropertyValue('--ground').trim() }));
  return new XMLSerializer().serializeToString(copy);
}

/** Saves a drawing as SVG, or as PNG in three times its size; a canvas as PNG. */
export async function save(kind, drawing, name) {
  if (drawing instanceof HTMLCanvasElement) {
    drawing.toBlob((found) => download(`${name}.png`, found));
    return;
  }
  drawing.querySelector('.ring')?.setAttribute('visibility', 'hidden');
  for (const one of drawing.querySelectorAll('.dim')) one.classList.remove('dim');
  const words = withLegend(drawing);
  if (kind === 'svg') { download(`${name}.svg`, words.text, 'image/svg+xml'); return; }
  const image = new Image();
  await new Promise((resolve, reject) => { image.onload = resolve; image.onerror = reject; image.src = URL.createObjectURL(new Blob([words.text], { type: 'image/svg+xml' })); });
  const board = document.createElement('canvas');
  board.width = 3 * words.width;
  board.height = 3 * words.height;
  board.getContext('2d').drawImage(image, 0, 0, board.width, board.height);
  URL.revokeObjectURL(image.src);
  board.toBlob((found) => download(`${name}.png`, found));
}

/** The drawing below its title and legend, which the page has next to it. */
function withLegend(drawing) {
  const { spec, width, height } = drawing.places, entries = spec.series.filter((one) => one.label);
  const across = Math.max(1, Math.floor(width / 190)), top = 26 + 18 * Math.ceil(entries.length / across);
  const copy = drawing.cloneNode(true);
  copy.setAttribute('height', height + top);
  copy.setAttribute('viewBox', `0 ${-top} ${width} ${height + top}`);
  const title = svg('text', { x: 62, y: 16 - top, class: 'name', 'font-weight': 600 });
  title.textContent = spec.title;
  copy.append(title);
  entries.forEach((one, i) => {
    const x = 62 + 190 * (i % across), y = 34 - top + 18 * Math.floor(i / across);
    copy.append(svg('line', { x1: x, x2: x + 26, y1: y - 4, y2: y - 4, stroke: one.color, 'stroke-dasharray': one.dash, 'stroke-width': one.width ?? 2 }));
    const label = svg('text', { x: x + 32, y });
    label.textContent = one.label;
    copy.append(label);
  });
  drawing.parentNode.append(copy);
  const text = alone(copy).replace('<rect width="100%"', `<rect y="${-top}" width="100%"`);
  copy.remove();
  return { text, width, height: height + top };
}
