// Comparisons at equal time and at equal quality; everything that was measured.

function tableOf(caption, heads, rows) {
  return make('div', {class: 'scroll'}, make('table', {}, make('caption', {}, caption),
    make('thead', {}, make('tr', {}, ...heads.map((head) => make('th', {scope: 'col'}, head)))),
    make('tbody', {}, ...rows.map((cells) => make('tr', {}, ...cells)))));
}

// A difference or a ratio with its interval; tinted where the interval is on one side of `neutral`.
function cellOf(estimate, write, neutral) {
  if (!estimate) return make('td', {class: 'none'}, '–');
  const [median, low, high] = estimate;
  const side = low === null ? '' : low > neutral ? 'gain' : high < neutral ? 'loss' : '';
  return make('td', {class: side}, write(median), low === null ? null : make('small', {}, `${write(low)} … ${write(high)}`));
}

function comparisonTable(entry, baseline, at, field, caption, write, neutral) {
  const all = entry.comparisons.filter((c) => c.baseline === baseline && c.at === at && c[field]);
  const values = [...new Set(all.map((c) => c.value))].sort((a, b) => a - b);
  const rows = [];
  for (const series of entry.series) {
    const own = all.filter((c) => c.series === series.name);
    if (own.length === 0 || isDetail(series.name)) continue;
    rows.push([make('td', {}, series.label),
      ...values.map((value) => cellOf((own.find((c) => c.value === value) || {})[field], write, neutral))]);
  }
  if (rows.length === 0) return null;
  const heads = values.map((value) => {
    const one = all.find((c) => c.value === value);
    if (at === 'psnr') return `${value} dB (${duration(one.seconds)})`;
    return `${value} ${at === 'spp' ? 'spp' : 'TC rays'} (${fixed(one.baseline_psnr, 1)} dB)`;
  });
  return tableOf(caption, ['', ...heads], rows);
}

function comparisonsOf(entry) {
  const baselines = [...new Set(entry.comparisons.map((c) => c.baseline))];
  const box = make('div', {class: 'comparisons'}), body = make('div');
  const decibels = (value) => `${signed(value)} dB`, times = (value) => `${fixed(value, 2)}×`;
  const show = (baseline) => {
    body.replaceChildren(...[
      comparisonTable(entry, baseline, 'psnr', 'gain', `dB more than ${baseline} in the time in which it reaches …`, decibels, 0),
      comparisonTable(entry, baseline, 'spp', 'gain', `dB more than ${baseline} in the time of its …`, decibels, 0),
      comparisonTable(entry, baseline, 'tc_rays', 'gain', `dB more than ${baseline} in the time of time-continuous rays …`, decibels, 0),
      comparisonTable(entry, baseline, 'psnr', 'speed', `times as fast as ${baseline} to …`, times, 1),
      comparisonTable(entry, baseline, 'spp', 'speed', `times as fast as ${baseline} to the quality of its …`, times, 1),
    ].filter((table) => table !== null));
    for (const button of box.querySelectorAll('.choice button'))
      button.setAttribute('aria-pressed', button.dataset.baseline === baseline);
  };
  if (baselines.length === 0) return make('p', {class: 'soft'}, 'No baseline was measured, or no curve meets its range.');
  box.append(make('div', {class: 'choice'}, 'Against qmc with', ...baselines.map((baseline) =>
    make('button', {type: 'button', 'data-baseline': baseline, onclick: () => show(baseline)}, baseline))), body);
  show(baselines[0]);
  return box;
}

function pointsTable(entry) {
  const pixels = entry.width * entry.height;
  const heads = ['', 'time', 'with building', 'PSNR, dB', 'relative MSE', 'rays / px', 'shaded / px', 'segments / ray', 'nodes / ray',
    'triangles / ray', 'roots / ray', 'ns / ray'];
  const rows = [];
  const seen = new Set();
  for (const series of entry.series)
    for (const p of series.points) {
      if (seen.has(p.name)) continue;
      seen.add(p.name);
      const counted = (value) => make('td', {}, p.nodes ? short(value / p.rays) : '–');
      rows.push([make('td', {}, `${isDetail(series.name) ? 'tc' : series.name}: ${p.label}`),
        make('td', {}, duration(p.seconds[0]), p.seconds[1] === null ? null :
          make('small', {}, `${duration(p.seconds[1])} … ${duration(p.seconds[2])}`)),
        make('td', {}, duration(p.seconds[0] + p.build)),
        make('td', {}, fixed(p.psnr[0], 2) + (p.near_reference ? ' *' : ''), p.psnr[1] === null ? null :
          make('small', {}, `${fixed(p.psnr[1], 2)} … ${fixed(p.psnr[2], 2)}`)),
        make('td', {}, short(p.relative_mse[0])),
        make('td', {}, short(p.rays / pixels)), make('td', {}, short(p.shaded / pixels)), make('td', {}, short(p.segments / p.rays)),
        counted(p.nodes), counted(p.triangles), counted(p.root_solves),
        make('td', {}, short(p.seconds[0] / p.rays * 1e9))]);
    }
  return make('details', {}, make('summary', {}, 'Every setting, with times and counters'),
    tableOf('Medians over seeds with 95 % intervals; counters of the first seed, those of Embree are not known', heads, rows),
    rows.length && entry.series.some((s) => s.points.some((p) => p.near_reference)) ?
      make('p', {class: 'soft'}, '* less than 10 dB below the reference: the error shown is partly the reference’s own.') : null);
}
