// The tooth pair, turning through the mesh, with its contacts and their loads.
import { byId, color, shown } from './util.js';

const SECONDS = 2.4;  // for a mesh period
const canvas = () => byId('teeth');
let scene = null, loads = null, phase = 0, isTurning = true, before = 0;
let paths = null;

/** One gear's teeth around the mesh as a path, turned to where contact begins. */
function pathOf(gear) {
  const pitch = 2 * Math.PI / gear.teeth, most = Math.min(gear.teeth, 15), path = new Path2D();
  // The outline runs one way round; each further tooth lies a pitch on.
  const angle = ([x, y]) => Math.atan2(x, y);
  const way = Math.sin(angle(gear.tooth[gear.tooth.length - 1]) - angle(gear.tooth[0])) > 0 ? 1 : -1;
  const from = gear.teeth > most ? -Math.floor(most / 2) : 0;
  for (let k = 0; k < most; k++) {
    const turn = way * (from + k) * pitch, cos = Math.cos(turn), sin = Math.sin(turn);
    gear.tooth.forEach(([x, y], i) => {
      const px = x * cos + y * sin, py = y * cos - x * sin;
      if (k === 0 && i === 0) { if (gear.teeth > most) { path.moveTo(px * 0.8, py * 0.8); path.lineTo(px, py); } else path.moveTo(px, py); } else path.lineTo(px, py);
      if (k === most - 1 && i === gear.tooth.length - 1 && gear.teeth > most) path.lineTo(px * 0.8, py * 0.8);
    });
  }
  path.closePath();
  return path;
}

/** Shows another pair; null where a case has no teeth. */
export function setScene(found) {
  scene = found;
  paths = found ? { pinion: pathOf(found.pinion), gear: pathOf(found.gear) } : null;
  canvas().hidden = !found;
  byId('noteeth').hidden = Boolean(found);
  draw();
}

/** The load of a pair over the path coordinate: `s` ascending, `load`, what its largest value is, and its unit. */
export function setLoads(found) {
  loads = found;
  draw();
}

function loadAt(s) {
  if (!loads || loads.s.length === 0 || s < loads.s[0] || s > loads.s[loads.s.length - 1]) return loads ? 0 : null;
  let low = 0, high = loads.s.length - 1;
  while (high - low > 1) { const middle = (low + high) >> 1; if (loads.s[middle] <= s) low = middle; else high = middle; }
  const span = loads.s[high] - loads.s[low];
  const part = span > 0 ? (s - loads.s[low]) / span : 0;
  return (loads.load[low] ?? 0) + part * ((loads.load[high] ?? 0) - (loads.load[low] ?? 0));
}

/** Contacts at this phase: where, how far along, and with what load. */
function contacts() {
  const found = [];
  const first = loads ? Math.floor(loads.s[0] - 1) : -1, last = loads ? loads.s[loads.s.length - 1] : scene.contact_ratio;
  for (let s = first + phase; s <= last + 1; s += 1) {
    const load = loadAt(s);
    if (load === null ? s < 0 || s > scene.contact_ratio : load <= 0) continue;
    const along = s * scene.base_pitch;
    found.push({ s, load, x: scene.start[0] + along * Math.cos(scene.angle), y: scene.start[1] + along * Math.sin(scene.angle) });
  }
  return found;
}

function arrow(pen, x, y, dx, dy, head) {
  const size = Math.hypot(dx, dy), ux = dx / size, uy = dy / size, h = Math.min(head, size);
  pen.beginPath();
  pen.moveTo(x - dx, y - dy);
  pen.lineTo(x - ux * h * 0.8, y - uy * h * 0.8);
  pen.stroke();
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x - ux * h - uy * h * 0.4, y - uy * h + ux * h * 0.4);
  pen.lineTo(x - ux * h + uy * h * 0.4, y - uy * h - ux * h * 0.4);
  pen.fill();
}

export function draw() {
  const board = canvas();
  if (!scene || board.hidden) return;
  const ratio = window.devicePixelRatio || 1, width = board.clientWidth, height = board.clientHeight;
  if (width === 0) return;
  if (board.width !== Math.round(width * ratio) || board.height !== Math.round(height * ratio)) {
    board.width = Math.round(width * ratio);
    board.height = Math.round(height * ratio);
  }
  const pen = board.getContext('2d');
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = color('sheet');
  pen.fillRect(0, 0, width, height);
  const wide = 2.4 * scene.base_pitch * Math.max(1.6, scene.contact_ratio), tall = Math.max(0.6 * wide, 7 * scene.module);
  const zoom = Math.min(width / wide, height / tall);
  const middle = scene.points.find((one) => one.name === 'P')?.place ?? scene.start;
  pen.translate(width / 2, height / 2);
  pen.scale(zoom, -zoom);
  pen.translate(-middle[0], -middle[1]);
  for (const name of ['pinion', 'gear']) gear(pen, name, zoom);
  lines(pen, zoom);
  forces(pen, zoom);
  names(pen, width, height, zoom);
  board.dataset.frames = String(Number(board.dataset.frames ?? 0) + 1);
}

function gear(pen, name, zoom) {
  const about = scene[name];
  const isAbove = name === 'gear';
  pen.save();
  if (isAbove) pen.translate(0, scene.centre);
  // The same picture comes again after a pitch, which is a mesh period.
  pen.rotate((isAbove ? 1 : -1) * about.turn * phase);
  pen.fillStyle = color(name);
  pen.strokeStyle = color('ink');
  pen.lineWidth = 1.1 / zoom;
  pen.lineJoin = 'round';
  pen.fill(paths[name]);
  pen.stroke(paths[name]);
  pen.restore();
  pen.beginPath();
  pen.setLineDash([9 / zoom, 3 / zoom, 2 / zoom, 3 / zoom]);
  pen.strokeStyle = color('muted');
  pen.lineWidth = 0.7 / zoom;
  pen.arc(0, isAbove ? scene.centre : 0, about.working_radius, 0, 2 * Math.PI);
  pen.stroke();
  pen.setLineDash([]);
}

function lines(pen, zoom) {
  const ends = [scene.points[0].place, scene.points[scene.points.length - 1].place];
  pen.strokeStyle = color('accent');
  pen.lineWidth = 1 / zoom;
  const far = 0.5 * scene.base_pitch, dx = Math.cos(scene.angle) * far, dy = Math.sin(scene.angle) * far;
  pen.beginPath();
  pen.moveTo(ends[0][0] - dx, ends[0][1] - dy);
  pen.lineTo(ends[1][0] + dx, ends[1][1] + dy);
  pen.stroke();
  for (const { place } of scene.points) {
    pen.beginPath();
    pen.arc(...place, 2.4 / zoom, 0, 2 * Math.PI);
    pen.fillStyle = color('sheet');
    pen.fill();
    pen.stroke();
  }
}

function forces(pen, zoom) {
  for (const one of contacts()) {
    pen.fillStyle = pen.strokeStyle = color('force');
    if (one.load > 0 && loads.largest > 0) {
      const long = 0.9 * scene.base_pitch * one.load / loads.largest;
      pen.lineWidth = 2.6 / zoom;
      arrow(pen, one.x, one.y, long * Math.cos(scene.angle), long * Math.sin(scene.angle), 9 / zoom);
    }
    pen.beginPath();
    pen.arc(one.x, one.y, 3.6 / zoom, 0, 2 * Math.PI);
    pen.fill();
  }
}

/** Letters upright and in pixels, whatever the scale. */
function names(pen, width, height, zoom) {
  const place = (x, y) => { const at = pen.getTransform().transformPoint({ x, y }); const ratio = window.devicePixelRatio || 1; return [at.x / ratio, at.y / ratio]; };
  const words = scene.points.map((one, i) => [one.name, ...place(...one.place), i % 2 ? 15 : -8]);
  const labels = contacts().filter((one) => one.load !== null).map((one) => [`${shown(one.load, 3)} ${loads.unit}`, ...place(one.x, one.y)]);
  pen.setTransform(window.devicePixelRatio || 1, 0, 0, window.devicePixelRatio || 1, 0, 0);
  pen.font = '600 12px system-ui, sans-serif';
  pen.lineWidth = 3;
  pen.strokeStyle = color('sheet');
  const write = (text, x, y, fill, align) => { pen.textAlign = align; pen.fillStyle = color(fill); pen.strokeText(text, x, y); pen.fillText(text, x, y); };
  for (const [name, x, y, dy] of words) write(name, x, y + dy, 'accent', 'center');
  labels.forEach(([text, x, y]) => write(text, x + 10, y + 26, 'force', 'left'));
  write('gear', width - 10, 20, 'muted', 'right');
  write('pinion, driving', width - 10, height - 10, 'muted', 'right');
}

function step(now) {
  const passed = Math.min(0.1, (now - before) / 1000);
  before = now;
  if (isTurning && scene && !document.hidden) {
    phase = (phase + passed / SECONDS) % 1;
    byId('phase').value = String(phase);
    draw();
  }
  requestAnimationFrame(step);
}

/** Begins to turn, unless whoever looks wants less motion. */
export function begin() {
  const board = canvas();
  if (matchMedia('(prefers-reduced-motion: reduce)').matches) turn(false);
  byId('play').addEventListener('click', () => turn(!isTurning));
  byId('phase').addEventListener('input', (event) => { turn(false); phase = Number(event.target.value) % 1; draw(); });
  new ResizeObserver(draw).observe(board);
  requestAnimationFrame(step);
}

function turn(on) {
  isTurning = on;
  byId('play').textContent = on ? 'Pause' : 'Turn';
  byId('play').setAttribute('aria-pressed', String(on));
}
