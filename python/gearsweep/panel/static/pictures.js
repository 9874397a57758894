// Which pictures there are, and how a table becomes one. What is not listed can be drawn as any column over another.
import { color, labelled, names, shown, title, unit } from './util.js';
import { between, style } from './chart.js';
import { state } from './state.js';

const ALONG = { needs: { contact_points: ['point', 's'] }, marks: 'points' };
/** What the search judges reliefs by, where its tables have these columns. */
const BY_STE = { set: ['optimum', 'judged', 'ste_peak_to_peak'] }, BY_FACTOR = { set: ['optimum', 'judged', 'dynamic_factor'], bound: 'at_least' };
/** What the task load needs for the torques. */
const TORQUE = { set: ['sweep', 'load_torque', '.true.'] };
const SPEED = { needs: { motion: ['resonance_rpm'] }, marks: 'resonance' };

/** What the branches may go along: their table has one of these columns. */
const PARAMETERS = ['rpm', 'damping_ratio', 'relief_um', 'normal_force_n'];
const BODIES = ['stress', 'modes', 'grid', 'gear_modes'];

/** Kind (curves where none is given), table, columns, what they are called where not by their names, and what else is fetched. */
export const PICTURES = [
  { id: 'sweep', title: 'Dynamic factor over speed', table: 'sweep', x: 'rpm', y: 'dynamic_factor', other: 'other_dynamic_factor', othername: 'in the other direction', seen: 'seen_dynamic_factor', ...SPEED },
  { id: 'largest', title: 'Largest dynamic factor of all motions over speed', table: 'sweep', x: 'rpm', y: ['dynamic_factor', 'largest_dynamic_factor'], yname: 'Dynamic factor', set: ['sweep', 'direction', 'all'], ...SPEED },
  { id: 'dte_rms', title: 'Dynamic transmission error over speed, root mean square', table: 'sweep', x: 'rpm', y: 'dte_rms_um', seen: 'seen_dte_rms_um', fromZero: true, ...SPEED },
  { id: 'dte_range', title: 'Dynamic transmission error over speed, peak to peak', table: 'sweep', x: 'rpm', y: 'dte_peak_to_peak_um', seen: 'seen_dte_peak_to_peak_um', fromZero: true, ...SPEED },
  { id: 'sweep_map', title: 'Dynamic factor over speed and relief', table: 'sweep', kind: 'map', x: 'rpm', y: 'relief_um', z: 'dynamic_factor' },
  { id: 'optimum', title: 'Largest dynamic factor over relief', table: 'optimum_curve', x: 'relief_um', y: 'worst_dynamic_factor', yname: 'Largest dynamic factor', needs: { optimum: ['relief_um', 'judged'] }, marks: 'optimum', ...BY_FACTOR },
  { id: 'optimum_ste', title: 'Peak-to-peak static transmission error over relief', table: 'optimum_curve', x: 'relief_um', y: 'ste_peak_to_peak_um', fromZero: true, ...BY_STE, needs: { optimum: ['relief_um', 'judged'] }, marks: 'optimum' },
  { id: 'ste_torques', title: 'Peak-to-peak static transmission error over torque, for some reliefs', table: 'optimum_map', task: 'optimum', x: 'torque_nm', y: 'ste_peak_to_peak_um', fromZero: true, few: 7, needs: { optimum: ['relief_um'] }, ...BY_STE },
  { id: 'ste_map', title: 'Peak-to-peak static transmission error over torque and relief', table: 'optimum_map', task: 'optimum', kind: 'map', x: 'torque_nm', y: 'relief_um', z: 'ste_peak_to_peak_um', ...BY_STE },
  { id: 'factor_torques', title: 'Largest dynamic factor over torque, for some reliefs', table: 'optimum_map', task: 'optimum', x: 'torque_nm', y: 'worst_dynamic_factor', yname: 'Largest dynamic factor', few: 7, needs: { optimum: ['relief_um'] }, ...BY_FACTOR },
  { id: 'factor_map', title: 'Largest dynamic factor over torque and relief', table: 'optimum_map', task: 'optimum', kind: 'map', x: 'torque_nm', y: 'relief_um', z: 'worst_dynamic_factor', ...BY_FACTOR },
  { id: 'relief_flank', title: 'Tip relief over the diameter', table: 'relief_flank', task: 'deflection_relief', x: 'diameter_mm', y: 'relief_um', first: 'method' },
  { id: 'relief_search', title: 'Largest dynamic factor over relief, as searched', table: 'relief_curve', task: 'deflection_relief', x: 'relief_um', y: 'worst_dynamic_factor', yname: 'Largest dynamic factor' },
  { id: 'contact_pattern', title: 'Contact pattern: pressure over face width and path', table: 'face_load', kind: 'map', x: 'z_mm', xname: 'Place z over the face width (mm)', y: 's', z: 'pressure_mpa', zname: 'Hertz pressure (MPa)', without: ['mesh_phase'], widths: 'slice_mm', low: 0, blank: 0, needs: { contact_points: ['s'] }, below: 'Upwards from root to tip of the pinion; white: no contact.', oblique: 'Lines: lines of contact as a pair enters; they move upwards.' },
  { id: 'face_misalignment', title: 'Face load factors over the misalignment', table: 'face_misalignments', task: 'face_load', x: 'misalignment_um', y: ['worst_face_load_factor', 'face_load_factor', 'root_face_load_factor', 'iso_face_load_factor'], yname: 'Face load factor', names: ['worst phase, K_Hβ', 'K_Hβ', 'root, K_Fβ', 'ISO 6336-1 method C'], set: ['face_load', 'misalignment_um', '-40, -30, -20, -10, 0, 10, 20, 30, 40'] },
  { id: 'face_factor', title: 'Load factor of the face over the mesh period', table: 'face_load_phases', task: 'face_load', x: 'mesh_phase', y: 'face_load_factor', yname: 'Largest load on one module over the mean' },
  { id: 'load', title: 'Load of one pair in motion', table: 'load', x: 's', y: 'pair_load_n', fromZero: true, ...ALONG },
  { id: 'dte', title: 'Dynamic transmission error', table: 'load', x: 's', y: 'dte_um', ...ALONG },
  { id: 'dte_harmonics', title: 'Harmonics of the dynamic transmission error', table: 'motion_harmonics', task: 'load', kind: 'bars', x: 'harmonic', y: 'dte_amplitude_um', above: 0 },
  { id: 'load_harmonics', title: 'Harmonics of the load of the mesh', table: 'motion_harmonics', task: 'load', kind: 'bars', x: 'harmonic', y: 'mesh_load_amplitude_n', above: 0 },
  { id: 'coast', title: 'Load on the coast flanks over speed', table: 'sweep', x: 'rpm', y: 'coast_factor', ...SPEED },
  { id: 'share', title: 'Static load share of one pair', table: 'mesh', x: 's', y: 'load_share', ...ALONG },
  { id: 'ste', title: 'Static transmission error', table: 'mesh', x: 's', y: 'ste_um', ...ALONG },
  { id: 'stiffness', title: 'Mesh stiffness', table: 'mesh', x: 's', y: 'mesh_stiffness_n_um', fromZero: true, ...ALONG },
  { id: 'pair_stiffness', title: 'Stiffness of one pair', table: 'mesh', x: 's', y: 'pair_stiffness_n_um', fromZero: true, ...ALONG },
  { id: 'profile_error', title: 'Profile error of a pair', table: 'mesh', x: 's', y: 'profile_error_um', ...ALONG },
  { id: 'torque', title: 'Torque of the pinion over time', table: 'torque', x: 'tau', xname: 'Time (mesh periods)', y: 'pinion_torque_nm', ...TORQUE },
  { id: 'torque_gear', title: 'Torque of the gear over time', table: 'torque', x: 'tau', xname: 'Time (mesh periods)', y: 'gear_torque_nm', ...TORQUE },
  { id: 'torque_friction', title: 'Friction’s share of the torque over time', table: 'torque', x: 'tau', xname: 'Time (mesh periods)', y: ['pinion_friction_nm', 'gear_friction_nm'], yname: 'Friction’s share (N·m)', ...TORQUE },
  { id: 'torque_harmonics', title: 'Harmonics of the torque of the pinion', table: 'torque_harmonics', task: 'load', kind: 'bars', x: 'harmonic', y: 'pinion_amplitude_nm', above: 0, ...TORQUE },
  { id: 'sensitivity', title: 'What changes the dynamic factor most', table: 'sensitivity', kind: 'ranking', x: 'relative_slope', xname: 'Change of DF for 1 % more (%)', y: 'number', yname: 'Input', also: ['derivative'] },
  { id: 'harmonics', title: 'Harmonics of the static transmission error', table: 'harmonics', kind: 'bars', x: 'harmonic', y: 'amplitude_um', above: 0 },
  { id: 'root', title: 'Root stress over the path of contact', table: 'static', x: 's', y: 'sigma_mpa', yname: 'Stress at the root tangent (MPa)', ...ALONG },
  { id: 'stress', title: 'Stress on the tooth', table: 'stress', task: 'static', kind: 'stress', set: ['static', 'field_position', '16'] },
  { id: 'modes', title: 'Natural modes, moving', table: 'mode_shapes', task: 'modal', kind: 'modes' },
  { id: 'section', title: 'Finite-element grid', table: 'elements', task: 'modal', kind: 'grid' },
  { id: 'stability', title: 'Stability over speed and damping', table: 'stability', kind: 'map', x: 'rpm', y: 'damping_ratio', z: 'floquet_modulus', low: 0, high: 2 },
  { id: 'tongues', title: 'Tongues of instability', table: 'tongue_edges', task: 'stability', y: 'damping_ratio', x: ['lower_rpm', 'upper_rpm'], xname: 'Speed (1/min)' },
  { id: 'hysteresis', title: 'Dynamic factor, run up and run down', table: 'hysteresis', x: 'rpm', y: 'dynamic_factor', first: 'direction', needs: { hysteresis_changes: null }, jumps: 'hysteresis_changes' },
  { id: 'ramps', title: 'Dynamic factor while the speed changes', table: 'hysteresis_ramps', task: 'hysteresis', x: 'rpm', y: 'dynamic_factor', first: 'direction', set: ['hysteresis', 'ramp_rpm_s', '1000'], ...SPEED },
  { id: 'poincare', title: 'Poincaré section over speed', table: 'poincare', kind: 'points', x: 'rpm', y: 'dte_um', without: ['period'] },
  { id: 'section_plane', title: 'Poincaré section, displacement and velocity', table: 'poincare', kind: 'points', x: 'dte_um', y: 'dte_rate_mm_s', without: ['period'] },
  { id: 'lyapunov', title: 'Lyapunov exponent over speed', table: 'lyapunov', task: 'poincare', x: 'rpm', y: 'lyapunov_exponent' },
  { id: 'attractors', title: 'All motions that attract', table: 'attractors', kind: 'points', x: 'rpm', y: 'dynamic_factor', first: 'motion', ylog: 'wide', share: 'share' },
  { id: 'basins', title: 'Which start leads to which motion', table: 'basins', task: 'attractors', kind: 'points', x: 'dte_um', y: 'dte_rate_mm_s', group: 'motion', without: ['start'] },
  { id: 'precision', title: 'Error over run time', table: 'precision', x: 'run_time_s', y: 'error', xlog: true, ylog: true, first: 'method', without: ['resolution'] },
  { id: 'pressure', title: 'Contact pressure', table: 'flank', x: 's', y: 'pressure_mpa', fromZero: true, ...ALONG },
  { id: 'sliding', title: 'Sliding speed', table: 'flank', x: 's', y: 'sliding_m_s', ...ALONG },
  { id: 'flash', title: 'Flash temperature', table: 'flank', x: 's', y: 'flash_temperature_k', fromZero: true, ...ALONG },
  { id: 'film', title: 'Oil film', table: 'flank', x: 's', y: 'film_thickness_um', fromZero: true, ...ALONG },
  { id: 'rating', title: 'Dynamic factor by Methods A and B of ISO 6336-1', table: 'dynamic_factors', task: 'rating', x: 'rpm', y: ['dynamic_factor_a', 'dynamic_factor_b'], yname: 'Dynamic factor', names: ['Method A: motion', 'Method B'] },
  { id: 'transient', title: 'Root stress while the load passes over a tooth', table: 'transient', x: 'time_ms', y: ['sigma_mpa', 'static_mpa'], yname: 'Stress at the root tangent (MPa)', first: 'side' },
  { id: 'transient_peaks', title: 'Largest root stress over speed', table: 'transient_peaks', task: 'transient', x: 'rpm', y: ['tension_mpa', 'static_tension_mpa', 'compression_mpa', 'static_compression_mpa'], yname: 'Largest root stress (MPa)' },
  { id: 'frequency', title: 'Root stress over the frequency of the load', table: 'harmonic', x: 'frequency_hz', y: 'stress_mpa', ylog: true, first: 'side' },
  { id: 'campbell', title: 'Where mesh harmonics meet natural frequencies', table: 'campbell', task: 'harmonic', kind: 'campbell', x: 'rpm', y: 'frequency_hz', order: 'harmonic' },
  { id: 'branches', title: 'Branches of periodic motions', table: 'branch_points', task: 'branches', kind: 'branches', x: PARAMETERS, y: 'dte_rms_um', yname: 'DTE, rms (µm)', ylog: 'wide', also: ['mesh_periods', 'stability', 'dynamic_factor'] },
  { id: 'branches_factor', title: 'Branches of periodic motions: dynamic factor', table: 'branch_points', task: 'branches', kind: 'branches', x: PARAMETERS, y: 'dynamic_factor', ylog: 'wide', also: ['mesh_periods', 'stability'] },
  { id: 'life', title: 'Stress amplitudes and the S-N curve', table: 'life_parts', task: 'life', kind: 'points', x: 'engagements', y: 'equivalent_amplitude_mpa', yname: 'Amplitude of the root stress (MPa)', xname: 'Load cycles: of one pass, and to failure', xlog: true, ylog: true, first: 'gear', without: ['part'],
    needs: { life_curve: ['failure_cycles', 'stress_mpa', 'gear', 'curve'] }, reference: { table: 'life_curve', x: 'failure_cycles', y: 'stress_mpa', label: 'S-N curve' } },
  { id: 'body_campbell', title: 'Speeds at which the mesh excites the modes of the whole gear', table: 'body_campbell', task: 'body_modes', kind: 'campbell', x: 'rpm', y: 'frequency_hz', order: 'per_turn', also: ['harmonic', 'nodal_diameter'],
    needs: { gear_body: ['sectors'], body_modes: ['mode_name'] } },
  { id: 'as_built', title: 'Dynamic factor over speed, as built and nominal', table: 'as_built', x: 'rpm', y: ['dynamic_factor', 'nominal_factor'], yname: 'Dynamic factor', names: ['as built', 'nominal'], first: 'relief_um', ...SPEED },
  { id: 'assemblies', title: 'Largest dynamic factor of each assembly', table: 'as_built_worst', task: 'as_built', kind: 'points', x: 'assembly', y: 'dynamic_factor', yname: 'Largest dynamic factor', first: 'relief_um' },
  { id: 'turn', title: 'Transmission error over the turn, at rest (speed 0) and in motion', table: 'as_built_turn', task: 'as_built', x: 'tau', xname: 'Time (mesh periods)', y: 'transmission_error_um', first: 'rpm' },
  { id: 'teeth', title: 'Largest load of each pair of teeth', table: 'as_built_loads', task: 'as_built', kind: 'bars', x: 'pair', y: 'load_ratio', yname: 'Load over static load' },
  { id: 'orders', title: 'Orders of the dynamic transmission error', table: 'as_built_orders', task: 'as_built', kind: 'points', x: 'order', y: 'dte_amplitude_um', ylog: true },
  { id: 'waterfall', title: 'Orders of the dynamic transmission error over speed', table: 'as_built_waterfall', task: 'as_built', kind: 'map', x: 'rpm', y: 'order', z: 'dte_amplitude_um', zlog: true, set: ['as_built', 'waterfall', '.true.'] },
  { id: 'gear_modes', title: 'Modes of the whole gear, moving', table: 'body_shapes', task: 'body_modes', kind: 'gear_modes' },
];

/** The picture of any columns of any table. */
export const own = (table, x, y) => ({ id: 'own', title: `${title(y)} over ${title(x)}`, table, x, y, task: null });

export const byName = (id) => PICTURES.find((one) => one.id === id);
const list = (one) => [one].flat();

/** Is it drawn as a body, on a canvas? */
export const isBody = (picture) => BODIES.includes(picture.kind);

/** Has a study what this picture shows? Some columns are there only where a key asks for them. */
export function isThere(picture, about) {
  const names = about[picture.table]?.columns.map((one) => one.name);
  return Boolean(names) && (isBody(picture) || [...list(picture.y), ...list(picture.z ?? [])].every((name) => names.includes(name)));
}

/** The columns of each table that a picture is drawn from. */
export function columnsOf(picture, about) {
  const table = about[picture.table];
  if (!table || isBody(picture)) return {};
  const index = table.columns.filter((one) => one.index).map((one) => one.name);
  const wanted = new Set([...index, ...list(picture.x), ...list(picture.y), ...list(picture.z ?? []), ...list(picture.group ?? []), ...list(picture.also ?? []), ...list(picture.other ?? []), ...list(picture.seen ?? []), ...list(picture.share ?? []), ...list(picture.order ?? []), ...list(picture.bound ?? []), ...list(picture.widths ?? [])]);
  const there = table.columns.map((one) => one.name);
  const found = { [picture.table]: [...wanted].filter((name) => there.includes(name)) };
  for (const [name, columns] of Object.entries(picture.needs ?? {})) if (about[name]) found[name] = columns;
  return found;
}

/** Index columns that tell curves apart, the one in front first: the others are chosen from. */
export function families(picture, about, columns) {
  if (picture.group) return [];
  const used = [...list(picture.x), ...list(picture.y), ...(picture.without ?? [])];
  const found = about[picture.table].columns.filter((one) => one.index && !used.includes(one.name))
    .map((one) => ({ ...one, values: [...new Set(columns[picture.table][one.name])] })).filter((one) => one.values.length > 1);
  return found.sort((a, b) => (b.name === picture.first) - (a.name === picture.first));
}

const word = (column, value) => `${column.name === 'gear' ? '' : `${title(column.name, column.unit)} `}${shown(value)}${column.unit ? ' ' + unit(column.unit) : ''}`;

/** The rows that hold these values of index columns. */
function rowsWhere(columns, where) {
  const n = Object.values(columns)[0].length, found = [];
  const tests = Object.entries(where).filter(([name]) => name in columns);
  for (let i = 0; i < n; i++) if (tests.every(([name, value]) => columns[name][i] === value)) found.push(i);
  return found;
}

/** A value of each of these index columns, as chosen where there is such a row; and the values that there are. */
function picked(families, columns, chosen) {
  const where = {}, further = [];
  for (const one of families) {
    const values = [...new Set(rowsWhere(columns, where).map((i) => columns[one.name][i]))];
    where[one.name] = values.includes(chosen[one.name]) ? chosen[one.name] : values[0];
    if (values.length > 1) further.push({ ...one, values, value: where[one.name] });
  }
  return { where, further };
}

/** Of many values, ascending, those nearest to a few equal steps, and the best one. */
function few(values, most, best) {
  const low = values[0], step = (values[values.length - 1] - low) / (most - 1);
  const wanted = [...Array.from({ length: most }, (_, i) => low + i * step), ...(Number.isFinite(best) ? [best] : [])];
  const kept = new Set(wanted.map((one) => values.reduce((a, b) => (Math.abs(b - one) < Math.abs(a - one) ? b : a))));
  return values.filter((value) => kept.has(value));
}

function marked(picture, data) {
  if (picture.marks === 'points' && data.contact_points) return data.contact_points.s.map((x, i) => ({ x, name: data.contact_points.point[i] }));
  if (picture.marks === 'resonance' && data.motion) return [{ x: data.motion.resonance_rpm[0], name: 'linear resonance' }];
  if (picture.marks === 'optimum' && data.optimum?.judged[0] === picture.set[2]) return [{ x: data.optimum.relief_um[0], name: `optimum ${shown(data.optimum.relief_um[0], 4)} µm` }];
  return [];
}

/** The face of helical gears, null for spur gears. A line of contact has another path coordinate on each slice: the pressure is interpolated at equal steps of the path. With the lines of contact as a pair enters. */
function oblique(picture, columns, rows, data) {
  const z = columns[picture.x], s = columns[picture.y], value = columns[picture.z], widths = columns[picture.widths];
  const xs = [...new Set(rows.map((i) => z[i]))].sort((a, b) => a - b), slices = xs.length, start = rows.filter((i) => z[i] === xs[0]);
  const fall = (s[rows[0]] - s[rows[slices - 1]]) / (xs[slices - 1] - xs[0]);
  if (!(fall > 0)) return null;
  const width = rows.slice(0, slices).reduce((sum, i) => sum + widths[i], 0), steps = 60;
  const [low, high] = [Math.min(...data.contact_points.s), Math.max(...data.contact_points.s)];
  const edges = Array.from({ length: steps + 1 }, (_, k) => low + (high - low) * k / steps), ys = between(edges);
  const along = xs.map((_, k) => start.map((i) => [s[i + k], value[i + k]]).sort((a, b) => a[0] - b[0]));
  const pressure = (places, at) => {
    const next = places.findIndex((one) => one[0] > at);
    if (next < 1) return null;
    const [[a, p], [b, q]] = [places[next - 1], places[next]];
    return p + (q - p) * (at - a) / (b - a) || null;
  };
  const lines = start.filter((i) => columns.mesh_phase[i] === 0).map((i) => s[i] + fall * xs[0])
    .map((top) => [[Math.max(0, (top - high) / fall), Math.min(top, high)], [Math.min(width, (top - low) / fall), Math.max(low, top - fall * width)]])
    .filter(([[a], [b]]) => b > a + 0.01 * width);
  return { xs, ys, z: ys.map((at) => along.map((places) => pressure(places, at))), walls: { x: [0, ...xs.map((x, k) => x + widths[rows[k]] / 2)], y: edges }, lines };
}

/** What the chart draws, of one study: `chosen` says which value of each further index column is shown. */
export function drawn(picture, about, data, chosen) {
  const table = about[picture.table], columns = data[picture.table];
  const column = (name) => table.columns.find((one) => one.name === name);
  const spec = { title: picture.title, below: picture.below, kind: picture.kind, xlog: picture.xlog, ylog: picture.ylog === 'wide' ? isWide(columns[picture.y]) : picture.ylog, fromZero: picture.fromZero,
    xlabel: picture.xname ?? labelled(column(list(picture.x)[0])), ylabel: picture.yname ?? labelled(column(list(picture.y)[0])) };
  // Where the search stopped early, a value is a lower bound only.
  const isBound = (i) => columns[picture.bound]?.[i] === 1;
  if (picture.kind === 'branches') return { ...spec, xlabel: labelled(column(parameterOf(columns))), kind: undefined, series: branches(columns, picture.y), lines: [], families: [] };
  if (picture.kind === 'campbell') return { ...spec, ...campbell(picture, columns, data), kind: undefined, families: [] };
  if (picture.kind === 'ranking') {
    const { where, further } = picked(families(picture, about, data), columns, chosen);
    return { ...spec, ...ranked(picture, columns, rowsWhere(columns, where)), lines: [], families: further };
  }
  if (picture.kind === 'map') {
    const { where, further } = picked(families(picture, about, data), columns, chosen);
    const face = picture.widths && oblique(picture, columns, rowsWhere(columns, where), data);
    if (face) return { ...spec, below: `${picture.below} ${picture.oblique}`, map: { ...face, label: picture.zname, low: picture.low, isPaper: true }, series: [], families: further };
    const xs = [...new Set(columns[picture.x])].sort((a, b) => a - b), ys = [...new Set(columns[picture.y])].sort((a, b) => a - b);
    const z = ys.map(() => xs.map(() => null));
    const isBlank = (i) => isBound(i) || columns[picture.z][i] === picture.blank;
    for (const i of rowsWhere(columns, where)) z[ys.indexOf(columns[picture.y][i])][xs.indexOf(columns[picture.x][i])] = isBlank(i) ? null : columns[picture.z][i];
    // Cells as wide as the table says; up to the first and last place along the other axis.
    const walls = picture.widths && { x: [0, ...xs.map((x) => x + columns[picture.widths][columns[picture.x].indexOf(x)] / 2)], y: [ys[0], ...between(ys), ys[ys.length - 1]] };
    return { ...spec, map: { xs, ys, z, walls, label: picture.zname ?? labelled(column(picture.z)), low: picture.low, high: picture.high, isLog: picture.zlog, isPaper: picture.blank !== undefined }, series: [], families: further };
  }
  let [first, ...further] = picture.group ? [{ ...column(picture.group), values: [...new Set(columns[picture.group])].sort((a, b) => a - b) }] : families(picture, about, data);
  const found = picked(further, columns, chosen), where = found.where;
  further = found.further;
  if (first) first = { ...first, values: first.values.filter((value) => rowsWhere(columns, { ...where, [first.name]: value }).length > 0) };
  const best = data.optimum?.relief_um[0];
  if (first && picture.few) first.values = few(first.values, picture.few, best);
  const groups = first ? first.values.map((value) => ({ label: `${word(first, value)}${picture.few && value === best ? ' (best)' : ''}`, where: { ...where, [first.name]: value } })) : [{ label: '', where }];
  const ys = [...list(picture.y), ...others(picture, columns)], xs = list(picture.x);
  let series = [];
  groups.forEach((group, g) => {
    const rows = rowsWhere(columns, group.where).filter((i) => picture.above === undefined || columns[picture.x][i] > picture.above);
    for (const yname of ys) for (const xname of xs) {
      const more = yname === picture.other ? picture.othername : ys.length > 1 && !picture.other ? picture.names?.[ys.indexOf(yname)] ?? title(yname, column(yname).unit) : '';
      series.push({ x: rows.map((i) => columns[xname][i]), y: rows.map((i) => (isBound(i) || (yname === picture.other && columns[yname][i] === columns[picture.y][i]) ? null : columns[yname][i])), reached: rows.map((i) => columns[picture.share]?.[i] !== 0), notes: picture.share ? rows.map((i) => `${shown(100 * columns[picture.share][i], 3)} % of the starts`) : undefined, group: g, part: ys.indexOf(yname) + xs.indexOf(xname),
        label: xname === xs[0] ? [group.label, more].filter(Boolean).join(', ') : '' });
    }
  });
  series = merged(series, first);
  const n = groups.length;
  for (const one of series) Object.assign(one, style(one.group, n), ys.length > 1 ? { dash: PARTS[one.part % PARTS.length] } : {});
  if (spec.kind === 'points') series.forEach((one, i) => { one.mark = i; });
  if (picture.share) series = series.flatMap(apart);
  if (picture.other) series = series.filter((one) => one.part === 0 || one.y.some((value) => value !== null));
  if (columns[picture.seen]) series.push(...seen(picture, columns, groups, n));
  if (picture.reference) series.unshift(lineOf(picture.reference, data));
  const arrows = picture.jumps && first ? series.flatMap((one) => jumps(one, data[picture.jumps], { ...where, [first.name]: first.values[one.group] })) : [];
  return { ...spec, series, arrows, lines: marked(picture, data), families: further };
}

/** What was seen of motions that do not repeat, hollow and not joined, in the colour of each group. */
function seen(picture, columns, groups, n) {
  const found = groups.map((group, g) => {
    const rows = rowsWhere(columns, group.where).filter((i) => columns[picture.seen][i] !== null);
    return { ...style(g, n), x: rows.map((i) => columns[picture.x][i]), y: rows.map((i) => columns[picture.seen][i]), kind: 'points', hollow: true, mark: 1, group: g,
      label: [group.label, 'seen, at least'].filter(Boolean).join(', ') };
  });
  return found.filter((one) => one.x.length > 0);
}

/** A second column, where it differs from the first somewhere. */
const others = ({ y, other }, columns) => (other && columns[other]?.some((value, i) => value !== columns[y][i]) ? [other] : []);

/** Do values ask for a logarithmic axis? */
function isWide(values) {
  const known = values.filter((value) => value !== null && value > 0);
  return known.length > 0 && Math.max(...known) > 10 * Math.min(...known);
}

/** A series of points as those that starts reach and, hollow, those that none reaches. */
function apart(one) {
  const take = (reached) => ({ ...one, ...Object.fromEntries(['x', 'y', 'notes'].map((name) => [name, one[name].filter((_, i) => one.reached[i] === reached)])) });
  const hollow = { ...take(false), hollow: true, label: [one.label, 'no start reaches it'].filter(Boolean).join(', ') };
  return [take(true), hollow].filter((some) => some.x.length > 0);
}

/** Takes the motions before and after each change of a run into its curve, which ends where the motion jumps: those jumps, as arrows. */
function jumps(series, changes, where) {
  const points = new Map(series.x.map((x, i) => [x, series.y[i]])), found = [], most = Math.max(...series.y);
  for (const i of rowsWhere(changes, where)) {
    const [before, after, from, to] = ['rpm_before', 'rpm_after', 'dynamic_factor_before', 'dynamic_factor_after'].map((name) => changes[name][i]);
    points.set(before, from).set(after, to);
    if (changes.kind[i] !== 'jump' && !(Math.abs(to - from) > 0.02 * most)) continue;
    points.set((before + after) / 2, null);
    if (from !== null && to !== null) found.push({ x: before, from, to, color: series.color, name: shown(Math.round(before)) });
  }
  series.x = [...points.keys()].sort((a, b) => a - b);
  series.y = series.x.map((x) => points.get(x));
  return found;
}

/** Lines of the mesh harmonics over the speeds of the case, natural frequencies that are not above them, and dots where they meet. */
function campbell({ order }, columns, data) {
  const { rpm, frequency_hz: hz, mode, harmonic } = columns, given = state.values.sweep ?? {}, least = Math.min(...hz) / 1000;
  const isBody = order === 'per_turn', teeth = isBody ? data.gear_body.sectors[0] : 1, slope = teeth * hz[0] / rpm[0] / columns[order][0] / 1000;
  const [low, high] = given.rpm_last ? [Number(given.rpm_first), Number(given.rpm_last)] : [0, 1.2 * least / slope];
  const most = Math.max(...harmonic), reach = 1.03 * Math.max(most * slope * high, least);
  const line = (y, more) => ({ x: [0, high], y, label: '', dash: '', width: 1, isPlain: true, ...more });
  const orders = Array.from({ length: most }, (_, i) => line([0, (i + 1) * slope * high], { color: color('muted'), notes: Array(2).fill(`${i + 1}x`) }));
  const words = (i) => (isBody ? data.body_modes.mode_name[mode[i] - 1] : columns.system[i] === 'gears' ? 'gears on the mesh' : `section, mode ${mode[i]}`);
  const waves = [...new Set(columns.nodal_diameter ?? [0])].sort((a, b) => a - b), hue = (i) => style(waves.indexOf(columns.nodal_diameter?.[i] ?? 0), waves.length).color;
  const rows = hz.flatMap((value, i) => (value / 1000 < reach ? [i] : [])), firsts = rows.filter((i) => rows.find((k) => words(k) === words(i) && hz[k] === hz[i]) === i);
  const modes = firsts.map((i) => line([hz[i] / 1000, hz[i] / 1000], { color: hue(i), notes: Array(2).fill(words(i)) }));
  const met = rows.filter((i) => rpm[i] <= high);
  const meets = { kind: 'points', label: '', mark: 0, color: color('ink'), x: met.map((i) => rpm[i]), y: met.map((i) => hz[i] / 1000),
    notes: met.map((i) => `${words(i)}, ${harmonic[i]}x${columns.nodal_diameter?.[i] ? `, ${columns[order][i]} times a turn of the gear` : ''}`) };
  const above = new Set(hz.filter((value) => value / 1000 >= reach));
  return { series: [...orders, ...modes, meets], extent: { x: [0, high], y: [0, reach] }, ylabel: 'Frequency (kHz)', lines: low > 0 ? [{ x: low, name: 'least speed of the case' }] : [],
    ends: [...orders.map((one) => ({ y: one.y[1], name: one.notes[0], color: one.color, inside: true })), ...firsts.map((i) => ({ y: hz[i] / 1000, name: `${words(i)}, ${shown(hz[i] / 1000, 4)} kHz`, color: hue(i) }))],
    below: above.size ? `Above: ${above.size} more, from ${shown(Math.min(...above) / 1000, 4)} kHz.` : '' };
}

/** Dashes of the columns of one picture. */
const PARTS = ['', '2 3', '8 3', '8 3 2 3'];

/** The S-N curve among points: of pinion and gear where these differ, with a gap between them. */
function lineOf({ table, x, y, label }, data) {
  const { gear, curve, [x]: cycles, [y]: stress } = data[table], rows = cycles.flatMap((_, i) => (i > 0 && gear[i] !== gear[i - 1] ? [-1, i] : [i]));
  const at = (values) => rows.map((i) => (i < 0 ? null : values[i]));
  return { x: at(cycles), y: at(stress), label: `${label} (${[...new Set(curve)].join(', ')})`, kind: 'line', color: color('ink'), dash: '' };
}

const parameterOf = (columns) => PARAMETERS.find((name) => name in columns);

/** Of each branch what attracts, solid, and what repels, dashed, in a colour for the mesh periods after which it repeats. */
function branches(columns, yname) {
  const x = columns[parameterOf(columns)], found = [], isLabelled = new Set();
  const periods = [...new Set(columns.mesh_periods)].sort((a, b) => a - b);
  for (const branch of new Set(columns.branch)) {
    const rows = columns.branch.flatMap((one, i) => (one === branch ? [i] : []));
    const of = columns.mesh_periods[rows[0]];
    for (const repels of [false, true]) {
      const is = (i) => (columns.stability[i] === 'unstable') === repels;
      // A piece goes on to the point where the other begins.
      const y = rows.map((i, k) => (is(i) || (k > 0 && is(rows[k - 1])) ? columns[yname][i] : null));
      if (!rows.some(is)) continue;
      const label = `${of === 1 ? 'repeats with the mesh' : `after ${of} periods`}${repels ? ', repels' : ''}`;
      found.push({ ...style(periods.indexOf(of), periods.length), x: rows.map((i) => x[i]), y, label: isLabelled.has(label) ? '' : label, dash: repels ? '4 3' : '' });
      isLabelled.add(label);
    }
  }
  return found;
}

/** A bar for each number, the longest first; those without a derivative stand last, with the word why. */
function ranked(picture, columns, rows) {
  const value = (i) => columns[picture.x][i], length = (i) => (value(i) === null ? -1 : Math.abs(value(i)));
  rows = [...rows].sort((a, b) => length(b) - length(a));
  const words = rows.map((i) => { const name = columns[picture.y][i]; return `${names.numbers[name] ?? name}${value(i) === null ? `: ${columns.derivative[i]}` : ''}`; });
  return { words, series: [{ x: rows.map(value), y: rows.map((_, k) => k), label: '', color: color('accent'), dash: '' }] };
}

/** Curves that are the same for all of the family are one. */
function merged(series, first) {
  if (!first || series.length < 2) return series;
  const [one] = series;
  const same = series.every((other) => other.y.length === one.y.length && other.y.every((value, i) => value === one.y[i] && other.x[i] === one.x[i]));
  return same ? [{ ...one, label: `any ${title(first.name, first.unit)}` }] : series;
}

/** Adds the curves of kept results: thinner, with marks of their own. */
export function withKept(spec, others) {
  if (spec.map || spec.words || spec.extent || spec.kind === 'bars' || others.length === 0) return spec;
  const series = [...spec.series];
  others.forEach(({ name, spec: other }, k) => {
    for (const one of other.series) series.push({ ...one, label: [name, one.label].filter(Boolean).join(': '), width: 1, mark: k, kept: true });
  });
  return { ...spec, series };
}
