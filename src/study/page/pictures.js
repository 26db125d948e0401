// Pictures side by side: a slider between any two, error maps, enlarged parts.

const HEAT = ['#000004', '#1b0c41', '#4a0c6b', '#781c6d', '#a52c60', '#cf4446', '#ed6925', '#fb9b06', '#f7d13d', '#fcffa4']
  .map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)));

// [code]: red, green, blue of an error code.
const HEAT_TABLE = Array.from({length: 256}, (_, code) => {
  const place = code / 255 * (HEAT.length - 1), below = Math.min(Math.floor(place), HEAT.length - 2), share = place - below;
  return HEAT[below].map((value, i) => Math.round(value + (HEAT[below + 1][i] - value) * share));
});

function loadImage(uri) {
  return new Promise((resolve, reject) => {
    const image = new Image();
    image.onload = () => resolve(image);
    image.onerror = () => reject(new Error('a picture cannot be shown'));
    image.src = uri;
  });
}

async function draw(canvas, uri, asHeat) {
  const image = await loadImage(uri);
  const context = canvas.getContext('2d', {willReadFrequently: asHeat});
  context.drawImage(image, 0, 0);
  if (!asHeat) return;
  const pixels = context.getImageData(0, 0, canvas.width, canvas.height);
  for (let i = 0; i < pixels.data.length; i += 4) pixels.data.set(HEAT_TABLE[pixels.data[i]], i);
  context.putImageData(pixels, 0, 0);
}

function heatScale() {
  const canvas = make('canvas', {width: 256, height: 1});
  const context = canvas.getContext('2d');
  HEAT_TABLE.forEach((rgb, code) => {
    context.fillStyle = `rgb(${rgb})`;
    context.fillRect(code, 0, 1, 1);
  });
  return make('div', {class: 'scale'}, 'difference 0.0001', canvas, '1 (logarithmic)');
}

// Its `ready` is a promise that ends when what was last chosen is shown.
function sliderOf(entry) {
  const {pictures} = entry;
  const choices = [{name: 'reference', image: pictures.reference, error: null,
    title: `reference, 2 × ${entry.reference_spp} spp`, caption: 'reference'},
    ...pictures.list.map((p) => ({...p, title: `${p.series}: ${p.label}, ${duration(p.seconds)}, ${fixed(p.psnr, 1)} dB`,
      caption: `${p.series}, ${p.label}\n${duration(p.seconds)}, ${fixed(p.psnr, 1)} dB`}))];
  const box = make('div', {class: 'comparator'});
  const canvases = [0, 1].map(() => make('canvas', {width: pictures.width, height: pictures.height}));
  const labels = ['a', 'b'].map((side) => make('div', {class: `label ${side}`, style: 'white-space: pre-line'}));
  const divider = make('div', {class: 'divider'});
  const slider = make('div', {class: 'slider', tabindex: 0, role: 'slider', 'aria-label': 'Divider between the two pictures',
    'aria-valuemin': 0, 'aria-valuemax': 100, style: `--picture-width: ${Math.max(pictures.width, 720)}px; --aspect: ${pictures.width} / ${pictures.height}`},
    canvases[1], canvases[0], divider, ...labels);
  const move = (percent) => {
    const place = Math.min(100, Math.max(0, percent));
    canvases[0].style.clipPath = `inset(0 ${100 - place}% 0 0)`;
    divider.style.left = `${place}%`;
    slider.setAttribute('aria-valuenow', Math.round(place));
  };
  const follow = (event) => {
    const frame = slider.getBoundingClientRect();
    move((event.clientX - frame.left) / frame.width * 100);
  };
  let dragging = false;
  slider.addEventListener('pointerdown', (event) => {
    dragging = true;
    if (event.isTrusted) slider.setPointerCapture(event.pointerId);
    follow(event);
  });
  slider.addEventListener('pointermove', (event) => { if (dragging) follow(event); });
  for (const event of ['pointerup', 'pointercancel']) slider.addEventListener(event, () => { dragging = false; });
  slider.addEventListener('keydown', (event) => {
    const step = {ArrowLeft: -2, ArrowRight: 2, Home: -100, End: 100}[event.key];
    if (step === undefined) return;
    move(Number(slider.getAttribute('aria-valuenow')) + step);
    event.preventDefault();
  });

  const selects = ['left', 'right'].map((side) => make('select', {'data-side': side, onchange: () => update()},
    ...choices.map((choice, i) => make('option', {value: i}, choice.title))));
  const mode = make('select', {'data-mode': '', onchange: () => update()}, make('option', {value: 'picture'}, 'pictures'),
    make('option', {value: 'error'}, 'error maps'));
  const scale = heatScale();
  const update = () => {
    const asError = mode.value === 'error';
    scale.hidden = !asError;
    scale.style.display = asError ? '' : 'none';
    box.ready = Promise.all(selects.map((select, i) => {
      const choice = choices[select.value];
      labels[i].textContent = choice.caption;
      const heat = asError && choice.error !== null;
      return draw(canvases[i], heat ? choice.error : choice.image, heat);
    }));
  };
  const last = (series) => choices.reduce((found, choice, i) => choice.series === series ? i : found, 0);
  selects[0].value = last('owen-sobol') || choices.length - 1;
  selects[1].value = last('auto') || last('mixed') || last('tc');
  box.append(make('div', {class: 'slider-controls'}, make('label', {}, 'left ', selects[0]), make('label', {}, 'right ', selects[1]),
    make('label', {}, 'show ', mode)), slider, scale);
  move(50);
  update();
  return box;
}

function cropsOf(entry) {
  const {pairs} = entry.pictures;
  const box = make('div', {class: 'crops-of'});
  if (pairs.length === 0) return make('p', {class: 'soft'}, 'No pictures of equal time.');
  const body = make('div');
  const show = (pair) => {
    body.replaceChildren(...pair.crops.map((crop) => make('div', {class: 'pair'},
      make('p', {class: 'soft'}, `Where ${pair.name} ${crop.gain ? 'wins' : 'loses'} most, by its squared error, against owen-sobol` +
        ` (pixels ${crop.box[0]}, ${crop.box[1]} to ${crop.box[0] + crop.box[2]}, ${crop.box[1] + crop.box[3]})`),
      make('div', {class: 'crops'}, ...crop.views.map((view) => make('figure', {},
        make('img', {src: view.image, alt: `${view.label}, enlarged`}),
        make('figcaption', {}, make('b', {}, view.label), view.psnr === null ? '' : ` ${fixed(view.psnr, 1)} dB here`)))))));
    if (pair.crops.length === 0) body.append(make('p', {class: 'soft'}, `${pair.name} and owen-sobol-${pair.spp} are equally far from the reference everywhere.`));
    for (const button of box.querySelectorAll('.choice button'))
      button.setAttribute('aria-pressed', button.dataset.name === `${pair.name}@${pair.spp}`);
  };
  const buttons = pairs.map((pair) => make('button', {type: 'button', 'data-name': `${pair.name}@${pair.spp}`, onclick: () => show(pair)},
    `${pair.name} in ${duration(pair.seconds)}`));
  box.append(make('div', {class: 'choice'}, ...buttons), body);
  show(pairs[pairs.length - 1]);
  return box;
}
