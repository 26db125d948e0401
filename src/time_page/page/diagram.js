// Time from left to right: above, how much each instant counts; below it, when each line is exposed; at the foot, what one pixel shows.

const TOP = 20, CURVE = 56, LINES = 130, SIGNAL = 96, GAP = 22, FOOT = 20, SIDE = 8;
const HIGH = TOP + CURVE + GAP + LINES + GAP + SIGNAL + FOOT;

function svg(name, attributes, ...children) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

// handles: what is dragged; onDrag(handle, time): where to.
class Diagram {
  constructor(place, onDrag) {
    this.place = place;
    this.onDrag = onDrag;
    this.root = svg('svg', {height: HIGH});
    place.append(this.root);
    this.root.addEventListener('pointerdown', (event) => this.press(event));
    this.root.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel']) this.root.addEventListener(end, () => { this.held = null; });
    this.root.addEventListener('keydown', (event) => this.key(event));
  }

  time(event) { return (event.clientX - this.root.getBoundingClientRect().left - SIDE) / this.width; }
  x(time) { return SIDE + time * this.width; }

  press(event) {
    const handle = event.target.dataset.handle;
    if (!handle) return;
    this.held = {handle, grabbed: this.time(event) - this.times[handle]};
    this.root.setPointerCapture(event.pointerId);
    event.preventDefault();
  }
  move(event) {
    if (this.held) this.onDrag(this.held.handle, this.time(event) - this.held.grabbed);
  }
  key(event) {
    const handle = event.target.dataset.handle, way = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    if (!handle || !way) return;
    event.preventDefault();
    this.onDrag(handle, this.times[handle] + way / 200);
    this.root.querySelector(`[data-handle="${handle}"][tabindex]`)?.focus();
  }

  handle(name, element, label) {
    element.dataset.handle = name;
    element.setAttribute('tabindex', 0);
    element.setAttribute('role', 'slider');
    element.setAttribute('aria-label', label);
    element.setAttribute('aria-valuenow', this.times[name].toFixed(3));
    return element;
  }

  draw(shutter, signal) {
    this.width = Math.max(100, this.place.clientWidth - 2 * SIDE);
    const [open, close] = interval(shutter, 0), last = lineCount(shutter) - 1, [lastOpen, lastClose] = interval(shutter, last);
    const length = close - open, lines = TOP + CURVE + GAP, foot = lines + LINES, x = (time) => this.x(time);
    this.times = {open, close, move: open, readout: lastClose, rise: open + shutter.rise * length, fall: open + shutter.fall * length};
    const parts = [];
    for (const [y, height] of [[TOP, CURVE], [lines, LINES], [foot + GAP, SIGNAL]])
      parts.push(svg('rect', {class: 'strip', x: x(0), y, width: this.width, height}));
    const count = WINDOW * DATA.fps, every = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100].find((step) => count / step <= 8) ?? count;
    for (let frame = Math.ceil(DATA.open * DATA.fps / every - 1e-6) * every; frame <= DATA.close * DATA.fps + 1e-6; frame += every) {
      const at = x((frame / DATA.fps - DATA.open) / WINDOW);
      parts.push(svg('line', {class: 'tick', x1: at, x2: at, y1: TOP, y2: foot + GAP + SIGNAL}));
      parts.push(svg('text', {x: at, y: HIGH - 4, 'text-anchor': 'middle'}, number(frame, 2)));
    }
    const caption = (y, text) => parts.push(svg('text', {x: x(0), y: y - 6}, text));
    caption(TOP, 'how much each instant counts: drag the upper corners');
    caption(lines, shutter.side === 'none' ? 'when the picture is exposed: drag its edges, or all of it' :
      `when each line is exposed, the first one (${shutter.side}) above: drag the knob below`);
    caption(foot + GAP, 'what the marked pixel shows over time (frames)');

    const points = (list) => list.map(([time, y]) => `${x(time)},${y}`).join(' ');
    const low = TOP + CURVE, high = TOP + 8;
    parts.push(svg('polygon', {class: 'curve', points: points([[open, low], [this.times.rise, high], [this.times.fall, high], [close, low]])}));
    parts.push(this.handle('rise', svg('circle', {class: 'knob', cx: x(this.times.rise), cy: high, r: 7}), 'end of the rise'));
    parts.push(this.handle('fall', svg('circle', {class: 'knob', cx: x(this.times.fall), cy: high, r: 7}), 'begin of the fall'));

    const body = svg('polygon', {class: 'body', points: points([[open, lines], [close, lines], [lastClose, foot], [lastOpen, foot]])});
    parts.push(this.handle('move', body, 'when'));
    for (const [name, from, to] of [['open', open, lastOpen], ['close', close, lastClose]]) {
      const ends = {x1: x(from), x2: x(to), y1: lines, y2: foot};
      parts.push(svg('line', {class: 'edge', ...ends}));
      parts.push(this.handle(name, svg('line', {class: 'grip', ...ends}), name));
    }
    if (shutter.side !== 'none')
      parts.push(this.handle('readout', svg('circle', {class: 'knob', cx: x(lastClose), cy: foot, r: 8}), 'time of reading all lines'));

    const middle = weightOf(shutter, signal.line);
    parts.push(svg('rect', {class: 'window', x: x(middle[0][0]), width: this.width * (middle.at(-1)[1] - middle[0][0]), y: foot + GAP, height: SIGNAL}));
    const top = Math.max(1e-3, ...signal.pieces.flatMap((piece) => [...piece.left, ...piece.right]));
    ['#d12a2a', '#1a8f3c', '#2a5bd1'].forEach((stroke, c) => {
      const line = signal.pieces.flatMap((piece) => [[piece.begin, piece.left[c]], [piece.end, piece.right[c]]]);
      parts.push(svg('polyline', {class: 'signal', stroke,
        points: points(line.map(([time, value]) => [time, foot + GAP + 4 + (SIGNAL - 8) * (1 - Math.max(0, value) / top)]))}));
    });
    this.root.replaceChildren(...parts);
  }
}
