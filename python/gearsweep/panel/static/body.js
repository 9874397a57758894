// The section of a gear: its grid, the stress all over it, and its modes as they move.
import { color, el, isDark, shown } from './util.js';

let frame = 0;
export function stopBody() { cancelAnimationFrame(frame); }

const TRIANGLES = [[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 7], [5, 6, 7]];
const AROUND = [0, 4, 1, 5, 2, 6, 3, 7];

const CORNERS = Array.from({ length: 8 }, (_, i) => `node_${i + 1}`);

export async function bodyOf(place, bar, one, state, need, save) {
  stopBody();
  const isWhole = one.kind === 'gear_modes', grids = isWhole ? ['body_nodes', 'body_elements'] : ['nodes', 'elements'];
  const study = state.study, columns = { [grids[0]]: ['x_mm', 'y_mm'], [grids[1]]: CORNERS };
  if (isWhole) Object.assign(columns, { body_modes: ['mode_name', 'frequency_hz', 'nodal_diameter', 'axial_share'], body_shapes: null, gear_body: ['sectors'] });
  if (one.kind === 'stress') Object.assign(columns, { stress: ['sigma_x_mpa', 'sigma_y_mpa', 'tau_xy_mpa'], stress_load: null, root_stress: null });
  if (one.kind === 'modes') Object.assign(columns, { mode_shapes: ['mode', 'shape_x', 'shape_y'], modal: ['mode', 'frequency_hz'] });
  const data = await need(study, columns);
  if (study !== state.study) return;
  const elements = data[grids[1]].node_1.map((_, e) => CORNERS.map((name) => data[grids[1]][name][e] - 1));
  const board = el('canvas', { className: 'bodyboard', role: 'img', 'aria-label': one.title });
  const note = el('p', { className: 'readout', role: 'status' });
  const shape = isWhole ? wholeGear(data, elements) : { x: data.nodes.x_mm, y: data.nodes.y_mm, elements };
  const buttons = [el('span', { className: 'gap' }), el('button', { type: 'button', onclick: () => save('png', board, `${state.name}.${one.id}`) }, 'PNG')];
  place.replaceChildren(bar, board, note);
  size(board, place);
  place.dataset.picture = one.id;
  if (one.kind === 'modes') {
    const { modal, mode_shapes: { shape_x: dx, shape_y: dy } } = data, n = shape.x.length;
    const all = modal.mode.map((mode, i) => ({ name: `${mode}: ${shown(modal.frequency_hz[i], 5)} Hz`, dx: dx.slice(i * n, (i + 1) * n), dy: dy.slice(i * n, (i + 1) * n) }));
    modes(bar, board, note, shape, all, buttons);
  } else if (isWhole) modes(bar, board, note, shape, gearModes(data, shape), buttons);
  else {
    bar.append(...buttons);
    if (one.kind === 'stress') stress(board, note, shape, data);
    else { grid(board, shape, shape.x, shape.y); note.textContent = `${shown(elements.length)} elements, ${shown(shape.x.length)} nodes.`; }
  }
}

function size(board, place) {
  const ratio = window.devicePixelRatio || 1, wide = Math.max(300, place.clientWidth - 2);
  const tall = Math.max(280, Math.min(520, wide * 0.6, window.innerHeight - place.getBoundingClientRect().top - 90));
  board.style.height = `${tall}px`;
  board.width = Math.round(wide * ratio);
  board.height = Math.round(tall * ratio);
}

/** A pen in mm, with the whole section in sight. */
function pen(board, shape) {
  const draw = board.getContext('2d'), wide = board.width, tall = board.height;
  draw.setTransform(1, 0, 0, 1, 0, 0);
  draw.fillStyle = color('sheet');
  draw.fillRect(0, 0, wide, tall);
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (const [i, list] of [shape.x, shape.y].entries()) for (const value of list) { low[i] = Math.min(low[i], value); high[i] = Math.max(high[i], value); }
  const zoom = 0.88 * Math.min(wide / (high[0] - low[0]), tall / (high[1] - low[1]));
  draw.translate(wide / 2, tall / 2);
  draw.scale(zoom, -zoom);
  draw.translate(-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2);
  draw.lineWidth = 0.8 * (window.devicePixelRatio || 1) / zoom;
  return draw;
}

function trace(draw, elements, x, y) {
  draw.beginPath();
  for (const nodes of elements) {
    AROUND.forEach((k, i) => draw[i ? 'lineTo' : 'moveTo'](x[nodes[k]], y[nodes[k]]));
    draw.closePath();
  }
}

function grid(board, shape, x, y) {
  const draw = pen(board, shape);
  trace(draw, shape.elements, x, y);
  draw.fillStyle = color('pinion');
  draw.strokeStyle = color('muted');
  draw.fill();
  draw.stroke();
}

/** Red is tension, blue compression, as pale as they are small; people who see no red from green can distinguish them. */
function warm(part) {
  const t = Math.max(-1, Math.min(1, part)), dark = isDark(), mix = (a, b, f) => a.map((value, i) => Math.round(value + f * (b[i] - value)));
  const none = dark ? [52, 58, 63] : [246, 246, 244];
  return `rgb(${(t >= 0 ? mix(none, dark ? [255, 122, 84] : [178, 24, 43], t) : mix(none, dark ? [96, 170, 255] : [33, 102, 172], -t)).join(',')})`;
}

function stress(board, note, shape, data) {
  const s = data.stress, larger = s.sigma_x_mpa.map((sx, i) => {
    const middle = (sx + s.sigma_y_mpa[i]) / 2, radius = Math.hypot((sx - s.sigma_y_mpa[i]) / 2, s.tau_xy_mpa[i]);
    return Math.abs(middle + radius) >= Math.abs(middle - radius) ? middle + radius : middle - radius;
  });
  const sorted = larger.map(Math.abs).sort((a, b) => a - b);
  // Under the load itself the stress of a node has no bound.
  const most = sorted[Math.floor(0.998 * (sorted.length - 1))] || 1;
  const draw = pen(board, shape);
  for (const nodes of shape.elements) for (const triangle of TRIANGLES) {
    const corners = triangle.map((k) => nodes[k]);
    draw.beginPath();
    corners.forEach((node, i) => draw[i ? 'lineTo' : 'moveTo'](shape.x[node], shape.y[node]));
    draw.closePath();
    draw.fillStyle = draw.strokeStyle = warm(corners.reduce((sum, node) => sum + larger[node], 0) / 3 / most);
    draw.fill();
    draw.stroke();
  }
  const load = data.stress_load;
  note.textContent = `The larger principal stress: red is tension, blue compression, full colour from ${shown(most, 3)} MPa on. Load at s = ${shown(load.s[0], 3)}, relief ${shown(load.relief_um[0])} µm, with ${shown(100 * load.load_share[0], 3)} % of the whole.`;
}

/** The front of all tooth sectors, from that of one. */
function wholeGear({ body_nodes: nodes, gear_body: { sectors: [sectors] } }, elements) {
  const x = [], y = [], all = [], n = nodes.x_mm.length;
  for (let k = 0; k < sectors; k++) {
    const cos = Math.cos(2 * Math.PI * k / sectors), sin = Math.sin(2 * Math.PI * k / sectors);
    for (let i = 0; i < n; i++) { x.push(nodes.x_mm[i] * cos - nodes.y_mm[i] * sin); y.push(nodes.x_mm[i] * sin + nodes.y_mm[i] * cos); }
    for (const corners of elements) all.push(corners.map((node) => node + k * n));
  }
  return { x, y, elements: all, sectors };
}

/** Modes of the whole gear: k sectors on, the first part of a shape counts by the cosine of k n pitches, the second by less the sine. */
function gearModes({ body_modes: about, body_shapes: parts }, { x, y, sectors }) {
  const n = x.length / sectors, found = [];
  for (let mode = 0; (mode + 1) * n <= parts.axial_cos.length; mode++) {
    const one = { name: `${mode + 1}: ${about.mode_name[mode]}, ${shown(about.frequency_hz[mode], 5)} Hz`, dx: [], dy: [], along: [], isAxial: about.axial_share[mode] > 0.5 };
    for (let i = 0; i < x.length; i++) {
      const at = mode * n + i % n, turn = 2 * Math.PI * Math.floor(i / n) * about.nodal_diameter[mode] / sectors;
      const [radial, tangential, axial] = ['radial', 'tangential', 'axial'].map((way) => Math.cos(turn) * parts[`${way}_cos`][at] - Math.sin(turn) * parts[`${way}_sin`][at]);
      const angle = Math.atan2(y[i], x[i]);
      one.dx.push(radial * Math.cos(angle) - tangential * Math.sin(angle));
      one.dy.push(radial * Math.sin(angle) + tangential * Math.cos(angle));
      one.along.push(axial);
    }
    found.push(one);
  }
  return found;
}

/** Modes that swing: what they do in the plane, and, of axial ones, their displacement along the axis as a colour. */
function modes(bar, board, note, shape, all, buttons) {
  const select = el('select', {}, ...all.map((one, i) => el('option', { value: i }, one.name)));
  bar.append(el('label', {}, 'Mode ', select), ...buttons);
  const extent = Math.max(...shape.x) - Math.min(...shape.x);
  const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
  const step = (now) => {
    const one = all[Number(select.value)], shift = still ? 1 : Math.sin(now / 350);
    const most = one.dx.reduce((size, value, i) => Math.max(size, Math.hypot(value, one.dy[i], one.along?.[i] ?? 0)), 0);
    const scale = 0.06 * extent / most * shift;
    const x = shape.x.map((value, i) => value + scale * one.dx[i]), y = shape.y.map((value, i) => value + scale * one.dy[i]);
    if (one.isAxial) axial(board, shape, x, y, one.along.map((value) => value / most * shift));
    else grid(board, shape, x, y);
    if (!still && document.contains(board)) frame = requestAnimationFrame(step);
  };
  select.addEventListener('change', () => { if (still) step(0); });
  note.textContent = `${all.length} modes; the deformation has no scale.${all.some((one) => one.isAxial) ? ' Of axial ones, red moves towards the eye and blue away.' : ''}`;
  frame = requestAnimationFrame(step);
}

/** Elements in the colour of their middle, over the outline in the plane. */
function axial(board, shape, x, y, value) {
  const draw = pen(board, shape);
  for (const nodes of shape.elements) {
    trace(draw, [nodes], x, y);
    draw.fillStyle = draw.strokeStyle = warm(nodes.reduce((sum, node) => sum + value[node], 0) / nodes.length);
    draw.fill();
    draw.stroke();
  }
}
