// Puts the page together: one shutter, drawn twice, as a diagram and as the picture that it makes.

const canvas = document.getElementById('picture'), context = canvas.getContext('2d');
canvas.width = DATA.width;
canvas.height = DATA.height;
canvas.style.aspectRatio = `${DATA.width * DATA.pixel_aspect} / ${DATA.height}`;
const image = context.createImageData(DATA.width, DATA.height);
const element = (id) => document.getElementById(id);

const state = {shutter: {...WHOLE, open: 0.25, close: 0.75}, view: DATA.view, exposure: 0, pixel: null, film: null};
let signals = null, colours = null, stale = false;

// What a pixel shows, for the diagram.
function signalOf(pixel) {
  const pieces = [];
  for (let i = signals.first[pixel]; i < signals.first[pixel + 1]; ++i) {
    const left = [0, 1, 2].map((c) => signals.left[3 * i + c]), right = left.map((value, c) => value + signals.step[3 * i + c]);
    pieces.push({begin: signals.begin[i], end: i + 1 < signals.first[pixel + 1] ? signals.begin[i + 1] : 1, left, right});
  }
  return {pieces, line: lineOf(state.shutter, pixel % DATA.width, Math.floor(pixel / DATA.width))};
}

// The pixel in which most happens.
function busiest() {
  let best = 0;
  for (let i = 1; i < PIXELS; ++i)
    if (signals.first[i + 1] - signals.first[i] > signals.first[best + 1] - signals.first[best]) best = i;
  return best;
}

function draw() {
  stale = false;
  colours = exposed(signals, state.shutter);
  show(colours, state.view, state.exposure, image.data);
  context.putImageData(image, 0, 0);
  const x = state.pixel % DATA.width, y = Math.floor(state.pixel / DATA.width);
  context.strokeStyle = '#fff';
  context.lineWidth = 1;
  context.strokeRect(x - 1.5, y - 1.5, 4, 4);
  diagram.draw(state.shutter, signalOf(state.pixel));
  element('says').textContent = saysOf(state.shutter);
  element('command').textContent = commandOf(state.shutter, state.view, state.exposure);
  element('reset_label').hidden = state.shutter.side === 'none';
  for (const button of document.querySelectorAll('#sides button'))
    button.setAttribute('aria-pressed', String(button.dataset.side === state.shutter.side));
  element('play').textContent = state.film ? 'stop' : 'play';
}

// Drawn once a frame of the screen at most, however often the mouse moves.
function change(shutter) {
  if (shutter) state.shutter = shutter;
  if (!stale) requestAnimationFrame(draw);
  stale = true;
}

function stop() { state.film = null; }

// Lets the shutter travel through all of the time, back and forth.
function play() {
  if (state.film) { stop(); change(); return; }
  const film = state.film = {};
  const begun = performance.now(), room = () => 1 - lag(state.shutter) - (state.shutter.close - state.shutter.open);
  if (room() < 0.05) state.shutter = {...state.shutter, open: 0, close: 0.1, readout: Math.min(state.shutter.readout, 0.5)};
  const step = (now) => {
    if (state.film !== film) return;
    const phase = ((now - begun) / 4000) % 2;
    state.shutter = dragged(state.shutter, 'move', (phase < 1 ? phase : 2 - phase) * room());
    draw();
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

function roll(side) {
  const s = {...state.shutter, side};
  if (side === 'none') return change({...s, readout: 0, reset: false});
  const length = Math.min(s.close - s.open, 0.1);
  if (s.readout === 0 || s.close + lag(s) > 1) Object.assign(s, {open: 0, close: length, readout: 1 - length});
  change(s);
}

const half = Math.min(1, 0.5 / (WINDOW * DATA.fps));
const presets = {
  'all of it': {}, 'half a frame': {close: half}, 'an instant': {open: 0.5, close: 0.5 + SHORTEST}, triangle: {rise: 0.5, fall: 0.5},
  'rolling': {side: 'top', close: 0.05, readout: 0.95},
};
for (const [name, changes] of Object.entries(presets)) {
  const button = document.createElement('button');
  button.textContent = name;
  button.addEventListener('click', () => { stop(); change({...WHOLE, ...changes}); });
  element('presets').append(button);
}
const playButton = document.createElement('button');
playButton.id = 'play';
playButton.addEventListener('click', play);
element('presets').append(playButton);
for (const side of SIDES) {
  const button = document.createElement('button');
  button.dataset.side = side;
  button.textContent = side === 'none' ? 'all lines at once' : `from the ${side}`;
  button.addEventListener('click', () => { stop(); roll(side); });
  element('sides').append(button);
}
element('reset').addEventListener('change', (event) => change({...state.shutter, reset: event.target.checked}));
element('exposure').addEventListener('input', (event) => { state.exposure = Number(event.target.value); change(); });
element('view').value = DATA.view;
element('view').addEventListener('change', (event) => { state.view = event.target.value; change(); });
canvas.addEventListener('pointerdown', (event) => {
  const frame = canvas.getBoundingClientRect();
  const x = clamp(Math.floor((event.clientX - frame.left) / frame.width * DATA.width), 0, DATA.width - 1);
  const y = clamp(Math.floor((event.clientY - frame.top) / frame.height * DATA.height), 0, DATA.height - 1);
  state.pixel = y * DATA.width + x;
  change();
});
window.addEventListener('resize', () => change());

const diagram = new Diagram(element('diagram'), (handle, time) => { stop(); change(dragged(state.shutter, handle, time)); });
element('facts').textContent = `${DATA.width} × ${DATA.height} pixels` +
  (DATA.factor > 1 ? `, each the mean of ${DATA.factor} × ${DATA.factor} of the rendering` : '') +
  `; ${(PIECES / PIXELS).toFixed(1)} straight pieces of time in each, ${number(WINDOW * 1000, 2)} ms of the scene. Click on the picture to mark a pixel.`;
unpackSignals().then((unpacked) => {
  signals = unpacked;
  state.pixel = busiest();
  draw();
  document.body.dataset.ready = 'yes';
});
