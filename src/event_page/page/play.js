"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const element = (id) => document.getElementById(id);

// Events, sorted by time: microseconds after the first, x, y and whether brighter.
const bytes = Uint8Array.from(atob(data.events), (c) => c.charCodeAt(0));
const words = new DataView(bytes.buffer);
const count = bytes.length / 8;
const timeOf = (i) => words.getUint32(8 * i, true);
const last = Math.max(timeOf(count - 1), 1);

/** The first event that is not before a time. */
function firstFrom(time) {
  let low = 0, high = count;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (timeOf(middle) < time) low = middle + 1; else high = middle;
  }
  return low;
}

function timeText(microseconds) {
  return microseconds >= 1e6 ? `${microseconds / 1e6} s` : microseconds >= 1e3 ? `${microseconds / 1e3} ms` : `${microseconds} µs`;
}

const state = { now: 0, window: 10000, speed: 0.1, playing: false };

const view = element("view");
view.width = data.width;
view.height = data.height;
const viewContext = view.getContext("2d");
const pixels = viewContext.createImageData(data.width, data.height);

/** What came within the window, the newest at full strength. */
function drawView() {
  pixels.data.fill(255);
  for (let i = firstFrom(state.now - state.window), end = firstFrom(state.now + 1); i < end; ++i) {
    const x = words.getUint16(8 * i + 4, true), packed = words.getUint16(8 * i + 6, true);
    const y = packed & 0x7fff, on = packed >> 15;
    if (x >= data.width || y >= data.height) continue;
    const age = Math.round(190 * Math.min(1, (state.now - timeOf(i)) / state.window));
    const at = 4 * (y * data.width + x);
    pixels.data[at] = on ? 208 + (age >> 2) : 32 + age;
    pixels.data[at + 1] = (on ? 48 : 80) + age * 0.85;
    pixels.data[at + 2] = on ? 48 + age : 208 + (age >> 2);
  }
  viewContext.putImageData(pixels, 0, 0);
}

const pictures = data.pictures.map((picture) => ({ begin: picture.begin, url: "data:image/png;base64," + picture.png }));
let shown = null;
function drawPicture() {
  const seconds = data.begin + state.now / 1e6;
  let current = pictures[0];
  for (const picture of pictures) if (picture.begin <= seconds) current = picture;
  if (current && current !== shown) element("picture").src = current.url;
  shown = current;
}

// How many events fall into each of even parts of the time.
const parts = 400;
const rates = { on: new Float64Array(parts), off: new Float64Array(parts) };
for (let i = 0; i < count; ++i) {
  const part = Math.min(parts - 1, Math.floor(timeOf(i) / (last + 1) * parts));
  ++(words.getUint16(8 * i + 6, true) >> 15 ? rates.on : rates.off)[part];
}
const most = Math.max(1, ...rates.on, ...rates.off);

const rate = element("rate");
function drawRate() {
  const width = rate.width = rate.clientWidth * devicePixelRatio, height = rate.height = rate.clientHeight * devicePixelRatio;
  const context = rate.getContext("2d");
  const bars = (values, colour, direction) => {
    context.fillStyle = colour;
    for (let i = 0; i < parts; ++i) {
      const length = values[i] / most * (height / 2 - 2);
      context.fillRect(i / parts * width, height / 2 - (direction > 0 ? length : 0), width / parts + 0.5, length);
    }
  };
  bars(rates.on, "#d03030", 1);
  bars(rates.off, "#2050d0", -1);
  const x = state.now / last * width;
  context.fillStyle = "#1d232b";
  context.fillRect(x - devicePixelRatio, 0, 2 * devicePixelRatio, height);
}

function draw() {
  drawView();
  if (pictures.length > 0) drawPicture();
  drawRate();
  element("now").value = `${(data.begin + state.now / 1e6).toFixed(6)} s`;
  element("span").textContent = timeText(state.window);
  rate.setAttribute("aria-valuetext", element("now").value);
}

function go(time) {
  state.now = Math.min(Math.max(time, 0), last);
  draw();
}

function choices(id, values, text, key) {
  const select = element(id);
  for (const value of values) select.add(new Option(text(value), value, false, value === state[key]));
  select.onchange = () => { state[key] = Number(select.value); draw(); };
}
choices("speed", [1, 0.1, 0.01, 0.001], (v) => v === 1 ? "real time" : `1/${1 / v}`, "speed");
choices("window", [100, 1000, 5000, 10000, 33000, 100000], timeText, "window");

let before = 0;
function tick(milliseconds) {
  if (!state.playing) return;
  const next = state.now + (milliseconds - before) * 1000 * state.speed;
  before = milliseconds;
  go(next >= last ? 0 : next);
  requestAnimationFrame(tick);
}
element("play").onclick = () => {
  state.playing = !state.playing;
  element("play").textContent = state.playing ? "Pause" : "Play";
  before = performance.now();
  requestAnimationFrame(tick);
};
const seek = (event) => go((event.clientX - rate.getBoundingClientRect().left) / rate.clientWidth * last);
rate.onpointerdown = (event) => { rate.setPointerCapture(event.pointerId); seek(event); };
rate.onpointermove = (event) => { if (event.buttons) seek(event); };
rate.onkeydown = (event) => {
  const step = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10 }[event.key];
  if (step) go(state.now + step * state.window / 10);
};
window.onresize = drawRate;

element("title").textContent = data.title;
element("facts").textContent = `${count} events in ${timeText(last)}, ${data.width}x${data.height} pixels, ` +
  `${(count / last).toPrecision(3)} million a second`;
element("beside").hidden = pictures.length === 0;
go(Math.min(last, 3 * state.window));
