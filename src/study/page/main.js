// Puts the page together from its data.

function sectionOf(entry) {
  const seeds = DATA.parameters.seeds;
  const which = entry.keys ? `at least ${entry.keys} motion keys` : 'the scene’s own motion keys';
  const keys = entry.moving_triangles ? `of which ${count(entry.moving_triangles)} move. Discrete rays have ${which}, which was the fastest ` +
    `of ${DATA.parameters.keys.join(', ')} (0: the scene’s own).` : 'of which none moves.';
  const near = entry.series.some((s) => s.points.some((p) => p.near_reference));
  return make('section', {class: 'entry', id: entry.name},
    make('h2', {}, `${entry.scene}, ${entry.shading} shading`),
    make('p', {class: 'soft'}, `${entry.width} × ${entry.height} pixels, ${count(entry.triangles)} triangles, ${keys} Reference: 2 × ` +
      `${count(entry.reference_spp)} samples per pixel in ${duration(entry.reference_seconds)}; its own error, by its halves: ` +
      `${fixed(entry.reference_psnr, 1)} dB. ${seeds} seed${seeds === 1 ? '' : 's'}.`),
    near ? make('p', {class: 'warning'}, 'Some points are less than 10 dB below the reference’s own error; the plots mark the region, the ' +
      'table below those points. Raise --reference-spp.') : null,
    make('h3', {}, 'Error against time'), plotsOf(entry),
    make('h3', {}, 'In equal time, and to equal quality'),
    make('p', {class: 'soft'}, 'Medians over seeds with 95 % intervals. Tinted blue: better than the baseline, the whole interval; orange: ' +
      'worse. A dash: one of the two curves does not reach there.'),
    comparisonsOf(entry),
    make('h3', {}, 'Pictures'),
    make('p', {class: 'soft'}, 'Of the first seed, in groups of about the same time: that of 16, 64 and 256 samples of owen-sobol, or of the ' +
      'most that it has. Drag the divider.'),
    sliderOf(entry),
    make('h3', {}, 'In equal time, enlarged'), cropsOf(entry),
    make('h3', {}, 'Numbers'), pointsTable(entry));
}

function colophon() {
  const facts = make('dl');
  const add = (name, value) => facts.append(make('dt', {}, name), make('dd', {}, value));
  add('command', DATA.command);
  for (const [name, value] of Object.entries(DATA.machine)) add(name, String(value));
  for (const [name, value] of Object.entries(DATA.parameters))
    if (value !== null && value !== '' && !(name in DATA.machine)) add(name, Array.isArray(value) ? value.join(', ') : String(value));
  return [make('h3', {}, 'How this was measured'),
    make('p', {}, `Errors are between linear colours, over all pixels and the three channels, with a box filter of one pixel. PSNR has a peak ` +
      `of 1: −10 log₁₀ of the mean squared error, and what is brighter counts as 1. Relative MSE is the mean of difference² / (reference² + ` +
      `0.01), of colours as they are. Time is that of rendering ` +
      `alone (${DATA.parameters.clock === 'cpu' ? 'processor time over threads' : 'wall clock'}, ${DATA.parameters.threads} ` +
      `thread${DATA.parameters.threads === 1 ? '' : 's'}); what is shorter than 0.15 s is rendered several times and the median taken. All ` +
      `methods take turns in one process, in one order for odd seeds and in the other for even ones.`),
    make('p', {}, 'Differences and ratios are taken within each seed, on straight lines between points over the logarithm of time; curves ' +
      'are continued by a quarter in time at most. The interval is Student’s, over seeds. qmc: discrete rays through Embree, geometry that ' +
      'stands still in a tree of its own. tc: time-continuous rays, N shading samples each. mixed, auto: both kinds of ray.'),
    make('p', {}, 'Beside this page: ', make('code', {}, 'runs.csv'), ' (every run), ', make('code', {}, 'curves.csv'), ', ',
      make('code', {}, 'comparisons.csv'), ', and all pictures in ', make('code', {}, 'pictures/'), '.'),
    facts];
}

const DATA = JSON.parse(document.getElementById('data').textContent);
const SCENES = new Set(DATA.entries.map((entry) => entry.scene)).size;
document.getElementById('summary').textContent = 'Methods of rendering motion blur, compared by their error in equal time: ' +
  `${SCENES} scene${SCENES === 1 ? '' : 's'}, ${DATA.machine.processor}, Kairos ${DATA.machine.version} (${DATA.machine.commit}).`;
document.getElementById('contents').append(...DATA.entries.map((entry) =>
  make('a', {href: `#${entry.name}`}, `${entry.scene}, ${entry.shading}`)));
document.getElementById('entries').append(...DATA.entries.map(sectionOf));
document.getElementById('colophon').append(...colophon());
if (location.hash === '#self-test') selfTest();
