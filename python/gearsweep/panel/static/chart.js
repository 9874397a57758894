// Curves, points, bars and maps over two axes, as SVG.
import { color, isDark, shown, svg } from './util.js';

const TOP = 10, BOTTOM = 44;
/** What is kept free on the right: for a bar of colours, or for names of lines. */
const rightOf = (spec) => 14 + (spec.map ? 78 : spec.ends ? 14 + 6.3 * Math.max(0, ...spec.ends.filter((one) => !one.inside).map((one) => one.name.length)) : 0);
/** Where the axes begin: an axis of words needs their room. */
const leftOf = (spec) => (spec.words ? 32 + 6.3 * Math.max(...spec.words.map((word) => word.length)) : 62);
const DASHES = ['', '7 3', '7 3 1.5 3', '1.5 3', '12 4'];
// From dark to light on a light ground and the other way on a dark one, in even steps of lightness: they differ in grey, too.
const RAMP = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37]];

/** The ramp's colour at a place from 0 to 1. */
export function ramp(place) {
  const at = Math.min(Math.max(place, 0), 1) * (RAMP.length - 1);
  const i = Math.min(Math.floor(at), RAMP.length - 2);
  return `rgb(${RAMP[i].map((value, k) => Math.round(value + (at - i) * (RAMP[i + 1][k] - value))).join(',')})`;
}

/** Colour and dashes of curve i of n. */
export function style(i, n) {
  const dark = isDark();
  if (n === 1) return { color: color('accent'), dash: '' };
  const place = i / (n - 1);
  return { color: ramp(dark ? 1 - 0.45 * place : 0.76 * place), dash: DASHES[i % DASHES.length] };
}

function ticks(low, high, most, isLog) {
  if (isLog) {
    const found = [];
    const from = Math.ceil(Math.log10(low) - 1e-9), to = Math.floor(Math.log10(high) + 1e-9);
    const each = Math.max(1, Math.ceil((to - from + 1) / most));
    for (let power = from; power <= to; power += each) found.push(10 ** power);
    if (found.length > 1) return found;
  }
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999);
  const found = [];
  for (let value = Math.ceil(low / step - 1e-9) * step; value <= high + step * 1e-9; value += step) found.push(Math.abs(value) < step * 1e-6 ? 0 : value);
  return found;
}

function tickWord(value) {
  if (value !== 0 && (Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3)) return value.toExponential().replace(/(\.\d{2})\d+/, '$1').replace('e+', 'e').replace('-', '−');
  return String(Number(value.toPrecision(8))).replace('-', '−');
}

/** Least and largest of all numbers, with room around them. */
function extent(lists, isLog, room) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const value of list) {
    if (value === null || (isLog && value <= 0)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return isLog ? [0.1, 1] : [0, 1];
  if (isLog) return [low / 1.15, high * 1.15];
  if (high === low) return high === 0 ? [0, 1] : [high - 0.2 * Math.abs(high), high + 0.2 * Math.abs(high)];
  const span = high - low;
  return [low - room * span, high + room * span];
}

function scale([low, high], from, to, isLog) {
  const f = isLog ? Math.log10 : (value) => value;
  const a = f(low), b = f(high);
  const place = (value) => from + (to - from) * (f(value) - a) / (b - a);
  place.back = (at) => { const value = a + (b - a) * (at - from) / (to - from); return isLog ? 10 ** value : value; };
  return place;
}

function axes(drawing, spec, width, height, x, y, ranges) {
  const grid = svg('g', { class: 'axes' }), left = leftOf(spec);
  const right = width - rightOf(spec), bottom = height - BOTTOM;
  for (const value of ticks(...ranges.x, Math.max(2, Math.floor((right - left) / 90)), spec.xlog)) {
    grid.append(svg('line', { x1: x(value), x2: x(value), y1: TOP, y2: bottom, class: 'grid' }),
      text(x(value), bottom + 16, tickWord(value), 'middle'));
  }
  const rows = spec.words?.map((word, i) => [i, word]) ?? ticks(...ranges.y, Math.max(2, Math.floor((bottom - TOP) / 50)), spec.ylog).map((value) => [value, tickWord(value)]);
  for (const [value, word] of rows) {
    if (!spec.words) grid.append(svg('line', { x1: left, x2: right, y1: y(value), y2: y(value), class: 'grid' }));
    grid.append(text(left - 7, y(value) + 4, word, 'end'));
  }
  grid.append(svg('path', { d: `M${left} ${TOP}V${bottom}H${right}`, class: 'frame' }),
    text((left + right) / 2, height - 8, spec.xlabel, 'middle', 'name'));
  const name = text(0, 0, spec.ylabel, 'middle', 'name');
  name.setAttribute('transform', `translate(14 ${(TOP + bottom) / 2}) rotate(-90)`);
  grid.append(name);
  drawing.append(grid);
}

function text(x, y, words, anchor, kind) {
  const node = svg('text', { x, y, 'text-anchor': anchor, class: kind });
  node.textContent = words;
  return node;
}

function curve(series, x, y, spec) {
  let path = '', isOpen = false;
  for (let i = 0; i < series.x.length; i++) {
    const a = series.x[i], b = series.y[i];
    if (a === null || b === null || (spec.ylog && b <= 0) || (spec.xlog && a <= 0)) { isOpen = false; continue; }
    path += `${isOpen ? 'L' : 'M'}${x(a).toFixed(1)} ${y(b).toFixed(1)}`;
    isOpen = true;
  }
  return path;
}

const MARKS = [
  (r) => `m${-r} 0a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`,
  (r) => `m${-r} ${-r}h${2 * r}v${2 * r}h${-2 * r}z`,
  (r) => `m0 ${-1.3 * r}l${1.2 * r} ${2 * r}h${-2.4 * r}z`,
  (r) => `m0 ${-1.4 * r}l${1.4 * r} ${1.4 * r}l${-1.4 * r} ${1.4 * r}l${-1.4 * r} ${-1.4 * r}z`,
];

/** The mark of a series as a path from its middle, of this size. */
export const markOf = (series, radius) => MARKS[(series.mark ?? 0) % MARKS.length](radius);

/** Marks at the points, or at some of them where they only tell a curve from others. */
function marks(series, x, y, spec, radius, most = Infinity) {
  const shape = markOf(series, radius);
  const each = Math.max(1, Math.ceil(series.x.length / most));
  let path = '';
  for (let i = Math.floor(each / 2) % each; i < series.x.length; i += each) {
    const a = series.x[i], b = series.y[i];
    if (a === null || b === null || (spec.ylog && b <= 0)) continue;
    path += `M${x(a).toFixed(1)} ${y(b).toFixed(1)}${shape}`;
  }
  return path;
}

function drawSeries(drawing, spec, x, y) {
  const body = svg('g', { class: 'body' });
  const bottom = spec.kind === 'bars' ? y(0) : 0;
  const n = spec.series.length;
  const places = spec.kind === 'bars' ? [...new Set(spec.series.flatMap((one) => one.x))].sort((a, b) => a - b) : [];
  const step = places.reduce((least, one, i) => (i ? Math.min(least, one - places[i - 1]) : least), 1);
  // Few points are drawn large enough to tell their shapes.
  const size = spec.series.reduce((sum, one) => sum + one.x.length, 0) < 300 ? 4 : 1.8;
  spec.series.forEach((series, i) => {
    const kind = series.kind ?? spec.kind;
    if (kind === 'bars') {
      const wide = Math.max(2, 0.8 * step * Math.abs(x(1) - x(0)) / n);
      series.x.forEach((value, k) => {
        if (series.y[k] === null) return;
        const top = y(series.y[k]);
        body.append(svg('rect', { x: x(value) - wide * (n / 2 - i), width: wide * 0.9, y: Math.min(top, bottom), height: Math.abs(bottom - top), fill: series.color }));
      });
    } else if (kind === 'ranking') {
      const tall = 0.7 * Math.abs(y(1) - y(0));
      series.x.forEach((value, k) => {
        if (value !== null) body.append(svg('rect', { x: Math.min(x(value), x(0)), width: Math.max(1, Math.abs(x(value) - x(0))), y: y(k) - tall / 2, height: tall, fill: series.color }));
      });
      body.append(svg('line', { x1: x(0), x2: x(0), y1: TOP, y2: y.floor, class: 'frame' }));
    } else if (kind === 'points') {
      body.append(svg('path', { d: marks(series, x, y, spec, size), fill: series.hollow ? 'none' : series.color, stroke: series.color, 'stroke-width': series.hollow ? 1 : 0.6 }));
    } else {
      body.append(svg('path', { d: curve(series, x, y, spec), stroke: series.color, 'stroke-dasharray': series.dash, 'stroke-width': series.width ?? 1.8, class: 'curve', 'data-series': i }));
      if (series.mark !== undefined) body.append(svg('path', { d: marks(series, x, y, spec, 3.2, 12), fill: color('ground'), stroke: series.color }));
      if (series.x.length < 40 && series.mark === undefined && !series.isPlain) body.append(svg('path', { d: marks(series, x, y, spec, 2.2, 40), fill: series.color }));
    }
  });
  for (const mark of spec.lines ?? []) {
    body.append(svg('line', { x1: x(mark.x), x2: x(mark.x), y1: TOP, y2: y.floor, class: 'aside' }), text(x(mark.x) + 3, TOP + 11, mark.name, 'start', 'asidename'));
  }
  drawing.append(body);
}

/** Jumps as arrows, with their names where there is room, those of the longest first. */
function drawArrows(drawing, spec, x, y) {
  const body = svg('g', { class: 'body' }), taken = [];
  for (const one of [...spec.arrows ?? []].sort((a, b) => Math.abs(b.to - b.from) - Math.abs(a.to - a.from))) {
    const at = x(one.x), tip = y(one.to), way = Math.sign(tip - y(one.from)), middle = (tip + y(one.from)) / 2;
    body.append(svg('path', { d: `M${at} ${y(one.from)}V${tip}m-3.5 ${-7 * way}l3.5 ${7 * way}l3.5 ${-7 * way}`, class: 'jump', fill: 'none', stroke: one.color, 'stroke-width': 1.3 }));
    if (taken.some(([a, b]) => Math.abs(a - at) < 46 && Math.abs(b - middle) < 14)) continue;
    taken.push([at, middle]);
    body.append(text(at + 5, middle + 4, one.name, 'start', 'jumpname'));
  }
  drawing.append(body);
}

/** Names at the right ends of lines, moved apart where they would overlap. */
function drawEnds(drawing, spec, x, y) {
  const body = svg('g', { class: 'ends' }), edge = x(spec.extent?.x[1] ?? 0);
  let last = Infinity;
  for (const one of [...spec.ends ?? []].sort((a, b) => a.y - b.y)) {
    if (one.inside) { body.append(text(edge - 3, y(one.y) + 12, one.name, 'end', 'asidename')); continue; }
    const at = Math.min(y(one.y), last - 13);
    if (at < TOP - 4) break;
    last = at;
    const name = text(edge + 12, at + 4, one.name, 'start');
    name.style.fill = one.color;
    body.append(svg('path', { d: `M${edge} ${y(one.y)}L${edge + 10} ${at}`, fill: 'none', stroke: one.color, 'stroke-width': 0.6 }), name);
  }
  drawing.append(body);
}

/** The middle between each two places. */
export const between = (list) => list.slice(1).map((value, i) => (list[i] + value) / 2);

/** Where the cells of a map begin and end: as it says, else halfway between its places. */
function wallsOf({ xs, ys, walls }) {
  const half = (list) => (list.length > 1 ? [list[1] - list[0], list[list.length - 1] - list[list.length - 2]] : [1, 1]).map((step) => step / 2);
  const around = (list) => { const [first, last] = half(list); return [list[0] - first, ...between(list), list[list.length - 1] + last]; };
  return walls ?? { x: around(xs), y: around(ys) };
}

function drawMap(drawing, spec, x, y, width, height) {
  const { xs, ys, z, isLog, isPaper } = spec.map;
  const known = z.flat().filter((value) => value !== null && !(isLog && value <= 0)), [least, most] = known.reduce(([a, b], one) => [Math.min(a, one), Math.max(b, one)], [Infinity, -Infinity]);
  // Of a logarithmic scale four powers of ten are shown.
  let low = spec.map.low ?? (isLog ? Math.max(least, most / 1e4) : least), high = spec.map.high ?? most;
  if (!(high > low)) high = low + (Math.abs(low) || 1) * 1e-6;
  const shade = scale([low, high], 0, 1, isLog);
  const shadeOf = (part) => ramp(isPaper ? 0.88 * (1 - part) : part), walls = wallsOf(spec.map);
  const body = svg('g', { class: 'body', 'shape-rendering': 'crispEdges' });
  // What is blank is so as on paper, and the ramp from light to dark, also on a dark ground.
  if (isPaper) body.append(svg('rect', { x: x(walls.x[0]), y: TOP, width: x(walls.x[xs.length]) - x(walls.x[0]), height: y.floor - TOP, fill: '#fff' }));
  for (let i = 0; i < xs.length; i++) for (let j = 0; j < ys.length; j++) {
    const value = z[j][i];
    if (value === null || value === undefined) continue;
    // Where one cell ends, the next begins, after rounding as well.
    const [a, b, c, d] = [x(walls.x[i]), x(walls.x[i + 1]), y(walls.y[j + 1]), y(walls.y[j])].map((at) => Math.round(10 * at) / 10);
    body.append(svg('rect', { x: a, y: c, width: Math.max(0.5, b - a).toFixed(1), height: Math.max(0.5, d - c).toFixed(1), fill: shadeOf(isLog && value <= 0 ? 0 : shade(value)) }));
  }
  for (const [[a, b], [c, d]] of spec.map.lines ?? []) for (const [stroke, wide] of [['#fff', 3.5], ['#000', 1.5]]) body.append(svg('line', { x1: x(a), y1: y(b), x2: x(c), y2: y(d), stroke, 'stroke-width': wide, 'shape-rendering': 'auto', class: 'contact' }));
  drawing.append(body);
  const right = width - 70, bar = svg('g', { class: 'axes' });
  for (let k = 0; k < 40; k++) bar.append(svg('rect', { x: right, width: 12, y: y.floor - (k + 1) * (y.floor - TOP) / 40, height: (y.floor - TOP) / 40 + 0.5, fill: shadeOf(k / 39) }));
  const at = scale([low, high], y.floor, TOP, isLog);
  for (const value of ticks(low, high, 5, isLog)) bar.append(text(right + 17, at(value) + 4, tickWord(value), 'start'));
  const name = text(0, 0, spec.map.label, 'middle', 'name');
  name.setAttribute('transform', `translate(${width - 4} ${(TOP + y.floor) / 2}) rotate(-90)`);
  bar.append(name);
  drawing.append(bar);
}

function ranges(spec) {
  if (spec.extent) return spec.extent;
  if (spec.map) {
    const { x, y } = wallsOf(spec.map), ends = (list) => [list[0], list[list.length - 1]];
    return { x: ends(x), y: ends(y) };
  }
  if (spec.words) return { x: extent([...spec.series.map((one) => one.x), [0]], false, 0.05), y: [spec.words.length - 0.5, -0.5] };
  const found = { x: extent(spec.series.map((one) => one.x), spec.xlog, spec.kind === 'bars' ? 0.08 : 0.01), y: extent(spec.series.map((one) => one.y), spec.ylog, 0.05) };
  if (spec.kind === 'bars' || spec.fromZero) found.y[0] = Math.min(0, found.y[0]);
  return found;
}

/** Draws into an element that has a width; the drawing, which a reader may hover and walk along by the arrow keys. */
export function chart(spec, width, height) {
  const drawing = svg('svg', { width, height, viewBox: `0 0 ${width} ${height}`, class: 'chart', role: 'img', tabindex: 0 });
  const name = svg('title');
  name.textContent = `${spec.title}: ${spec.ylabel} over ${spec.xlabel}`;
  drawing.append(name);
  const range = ranges(spec);
  const x = scale(range.x, leftOf(spec), width - rightOf(spec), spec.xlog);
  const y = scale(range.y, height - BOTTOM, TOP, spec.ylog);
  y.floor = height - BOTTOM;
  if (spec.map) drawMap(drawing, spec, x, y, width, height);
  axes(drawing, spec, width, height, x, y, range);
  if (!spec.map) drawSeries(drawing, spec, x, y);
  drawArrows(drawing, spec, x, y);
  drawEnds(drawing, spec, x, y);
  drawing.places = { x, y, spec, width, height };
  return drawing;
}

/** What stands at a place of a drawing: the nearest point, or the cell of a map. */
export function nearest(drawing, px, py) {
  const { x, y, spec } = drawing.places;
  if (spec.map) {
    const close = (list, value) => list.reduce((best, one, i) => Math.abs(one - value) < Math.abs(list[best] - value) ? i : best, 0);
    const i = close(spec.map.xs, x.back(px)), j = close(spec.map.ys, y.back(py));
    return { x: spec.map.xs[i], y: spec.map.ys[j], z: spec.map.z[j][i], px: x(spec.map.xs[i]), py: y(spec.map.ys[j]) };
  }
  if (spec.words) {
    const [{ x: values }] = spec.series, i = Math.min(values.length - 1, Math.max(0, Math.round(y.back(py))));
    return { x: values[i], y: i, s: 0, i, px: x(values[i] ?? 0), py: y(i) };
  }
  let best = null, least = Infinity;
  spec.series.forEach((series, s) => series.x.forEach((a, i) => {
    const b = series.y[i];
    if (a === null || b === null || (spec.ylog && b <= 0)) return;
    const far = (x(a) - px) ** 2 + 0.3 * (y(b) - py) ** 2;
    if (far < least) { least = far; best = { x: a, y: b, s, i, label: series.label, note: series.notes?.[i], px: x(a), py: y(b) }; }
  }));
  return best;
}

/** A value with the words of its axis: name, number, unit. */
function placed(label, value) {
  const [, name, of] = /^(.*?)(?: \(([^()]*)\))?$/.exec(label), isWord = /^.[a-z ]/.test(name);
  return [isWord ? name.charAt(0).toLowerCase() + name.slice(1) : name, shown(value), of].filter(Boolean).join(' ');
}

/** A point in words. */
export function readoutOf(spec, at) {
  if (!at) return '';
  if (spec.map) return `${placed(spec.map.label, at.z)} at ${placed(spec.xlabel, at.x)}, ${placed(spec.ylabel, at.y)}`;
  if (spec.words) return at.x === null ? `${spec.words[at.y]}, no derivative` : `${spec.words[at.y]}: ${shown(at.x)} per cent of DF for one per cent`;
  return `${at.label ? at.label + ': ' : ''}${placed(spec.ylabel, at.y)} at ${placed(spec.xlabel, at.x)}${at.note ? `, ${at.note}` : ''}`;
}
