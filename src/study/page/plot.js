// Error against time: two plots with one legend.

const PLOT = {width: 600, height: 400, left: 58, right: 14, top: 30, bottom: 46};

// Round values between two, for an axis.
function linearTicks(low, high) {
  const rough = (high - low) / 6;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
  const ticks = [];
  for (let i = Math.ceil(low / step); i * step <= high * (1 + 1e-9); ++i) ticks.push(i * step);
  return ticks;
}
function logTicks(low, high) {
  const factors = high / low > 1000 ? [1] : high / low > 30 ? [1, 3] : [1, 2, 5];
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); 10 ** power <= high; ++power)
    for (const factor of factors)
      if (factor * 10 ** power >= low && factor * 10 ** power <= high) ticks.push(factor * 10 ** power);
  return ticks;
}

function scaleOf(values, logarithmic, from, to) {
  const place = logarithmic ? Math.log : (v) => v;
  let low = Math.min(...values), high = Math.max(...values);
  if (low === high) [low, high] = logarithmic ? [low / 2, high * 2] : [low - 1, high + 1];
  const margin = (place(high) - place(low)) * 0.05;
  const first = place(low) - margin, last = place(high) + margin;
  const scale = (value) => from + (to - from) * (place(value) - first) / (last - first);
  const back = logarithmic ? Math.exp : (v) => v;
  scale.ticks = (logarithmic ? logTicks : linearTicks)(back(first), back(last));
  return scale;
}

function tipText(series, point, entry) {
  const lines = [`${series.label}: ${point.label}`,
    `${duration(point.seconds[0])} (and ${duration(point.build)} to build)`,
    `PSNR ${fixed(point.psnr[0], 2)} dB` +
      (point.psnr[1] === null ? '' : `  [${fixed(point.psnr[1], 2)}, ${fixed(point.psnr[2], 2)}]`),
    `relative MSE ${short(point.relative_mse[0])}`,
    `${short(point.rays / entry.width / entry.height)} rays and ${short(point.shaded / entry.width / entry.height)} shaded a pixel`];
  if (point.near_reference) lines.push('less than 10 dB below the reference');
  return lines.join('\n');
}

// kind: 'psnr' or 'relative_mse'. Returns the figure; groups[series name] are what the legend shows and hides.
function plotOf(entry, kind, groups) {
  const {width, height, left, right, top, bottom} = PLOT;
  const logarithmic = kind === 'relative_mse';
  const all = entry.series.flatMap((series) => series.points).filter((p) => p[kind][0] !== null && p[kind][0] > 0);
  const figure = make('figure', {class: 'plot'});
  if (all.length === 0) return figure;
  const x = scaleOf(all.map((p) => p.seconds[0]), true, left, width - right);
  const y = scaleOf(all.map((p) => p[kind][0]), logarithmic, height - bottom, top);
  const inside = (place) => Math.min(height - bottom, Math.max(top, place));  // wide intervals end at the frame
  const title = kind === 'psnr' ? 'PSNR, dB' : 'relative MSE';
  const svg = makeSvg('svg', {viewBox: `0 0 ${width} ${height}`, role: 'img',
    'aria-label': `${title} against rendering time, ${entry.name}`});
  const text = (string, attributes) => makeSvg('text', attributes, string);
  for (const tick of x.ticks)
    svg.append(makeSvg('line', {class: 'grid', x1: x(tick), x2: x(tick), y1: top, y2: height - bottom}),
      text(duration(tick), {x: x(tick), y: height - bottom + 18, 'text-anchor': 'middle'}));
  for (const tick of y.ticks)
    svg.append(makeSvg('line', {class: 'grid', x1: left, x2: width - right, y1: y(tick), y2: y(tick)}),
      text(short(tick), {x: left - 8, y: y(tick) + 4, 'text-anchor': 'end'}));
  svg.append(makeSvg('line', {class: 'axis', x1: left, x2: width - right, y1: height - bottom, y2: height - bottom}),
    text(title, {class: 'title', x: left, y: top - 12}),
    text('rendering time, logarithmic', {x: width - right, y: height - 8, 'text-anchor': 'end'}));
  if (kind === 'psnr' && entry.reference_psnr !== null) {
    const limit = y(entry.reference_psnr - 10);
    if (limit > top)
      svg.append(makeSvg('rect', {class: 'limit', x: left, y: top, width: width - left - right, height: limit - top}),
        text('within 10 dB of the reference', {x: left + 6, y: top + 15}));
  }
  const tip = make('div', {class: 'tip', hidden: ''});
  const show = (series, point) => {
    tip.textContent = tipText(series, point, entry);
    tip.hidden = false;
    const share = figure.clientWidth / width;
    const toTheLeft = x(point.seconds[0]) > width / 2;
    tip.style.left = toTheLeft ? '' : `${x(point.seconds[0]) * share + 12}px`;
    tip.style.right = toTheLeft ? `${(width - x(point.seconds[0])) * share + 12}px` : '';
    tip.style.top = `${Math.min(y(point[kind][0]), height - 120) * share}px`;
  };
  // The main ones lie on top of the details.
  for (const series of [...entry.series].sort((a, b) => isDetail(b.name) - isDetail(a.name))) {
    const look = lookOf(series.name);
    const points = series.points.filter((p) => p[kind][0] !== null && p[kind][0] > 0);
    const group = makeSvg('g', {'data-series': series.name});
    const line = points.map((p, i) => `${i ? 'L' : 'M'}${x(p.seconds[0]).toFixed(1)},${y(p[kind][0]).toFixed(1)}`).join('');
    group.append(makeSvg('path', {d: line, fill: 'none', stroke: look.colour, 'stroke-width': look.thin ? 1.5 : 2.2,
      'stroke-dasharray': look.dash || 'none', 'stroke-linejoin': 'round'}));
    for (const point of points) {
      const [px, py] = [x(point.seconds[0]), y(point[kind][0])];
      const [low, high] = [point[kind][1], point[kind][2]];
      if (low !== null && !(logarithmic && low <= 0) && !look.thin)
        group.append(makeSvg('line', {x1: px, x2: px, y1: inside(y(low)), y2: inside(y(high)), stroke: look.colour, 'stroke-opacity': 0.6}));
      group.append(marker(look.shape, px, py, look.colour, look.thin ? 3 : 4.5));
      const hit = makeSvg('circle', {class: 'hit', cx: px, cy: py, r: 11, tabindex: 0, 'aria-label': tipText(series, point, entry)});
      for (const event of ['pointerenter', 'focus']) hit.addEventListener(event, () => show(series, point));
      for (const event of ['pointerleave', 'blur']) hit.addEventListener(event, () => { tip.hidden = true; });
      group.append(hit);
    }
    (groups[series.name] = groups[series.name] || []).push(group);
    svg.append(group);
  }
  figure.append(svg, tip);
  return figure;
}

function plotsOf(entry) {
  const groups = {};
  const plots = make('div', {class: 'plots'}, plotOf(entry, 'psnr', groups), plotOf(entry, 'relative_mse', groups));
  const legend = make('div', {class: 'legend', role: 'group', 'aria-label': 'Lines to show'});
  for (const series of [...entry.series].sort((a, b) => isDetail(a.name) - isDetail(b.name))) {
    const look = lookOf(series.name);
    const sign = makeSvg('svg', {width: 26, height: 12, 'aria-hidden': 'true'},
      makeSvg('line', {x1: 0, x2: 26, y1: 6, y2: 6, stroke: look.colour, 'stroke-width': 2, 'stroke-dasharray': look.dash || 'none'}),
      marker(look.shape, 13, 6, look.colour, 3.5));
    const set = (on) => {
      button.setAttribute('aria-pressed', on);
      for (const group of groups[series.name] || []) group.classList.toggle('hidden', !on);
    };
    const button = make('button', {type: 'button', 'data-series': series.name,
      onclick: () => set(button.getAttribute('aria-pressed') !== 'true')}, sign, series.label);
    set(true);
    legend.append(button);
  }
  return make('div', {}, legend, plots,
    make('p', {class: 'soft'}, 'Up and to the left is better on the left, down and to the left on the right. Bars are 95 % intervals ' +
      'over seeds. Click a method to hide it, point at a mark for its numbers.'));
}
