// The shutter: when each line is exposed, and how much each instant of that counts. Times are parts of the recorded one.

const WINDOW = DATA.close - DATA.open;  // seconds
const SHORTEST = 1 / 256;
const SIDES = ['none', 'top', 'bottom', 'left', 'right'];

// open, close: of the first line; readout: of all lines; rise, fall: of the curve, in parts of a line's interval.
const WHOLE = {open: 0, close: 1, side: 'none', readout: 0, reset: false, rise: 0, fall: 1};

function lineCount(shutter) { return shutter.side === 'left' || shutter.side === 'right' ? DATA.frame[0] : DATA.frame[1]; }

// By how much the last line is later than the first.
function lag(shutter) {
  if (shutter.side === 'none') return 0;
  const lines = lineCount(shutter);
  return shutter.readout * (lines - 1) / lines;
}

function clamp(value, least, most) { return Math.min(Math.max(value, least), most); }

// The shutter with one of its handles where it was dragged to, inside of what is recorded.
function dragged(shutter, handle, time) {
  const s = {...shutter}, late = lag(s), length = s.close - s.open;
  if (handle === 'open') s.open = clamp(time, 0, s.close - SHORTEST);
  if (handle === 'close') s.close = clamp(time, s.open + SHORTEST, 1 - late);
  if (handle === 'move') {
    s.open = clamp(time, 0, 1 - late - length);
    s.close = s.open + length;
  }
  if (handle === 'readout') {  // time: where the last line closes
    const lines = lineCount(s);
    s.readout = clamp(time - s.close, 0, 1 - s.close) * lines / Math.max(1, lines - 1);
  }
  if (handle === 'rise') s.rise = clamp((time - s.open) / length, 0, s.fall);
  if (handle === 'fall') s.fall = clamp((time - s.open) / length, s.rise, 1);
  return s;
}

// Of a pixel of this page's picture: the full frame's line in its middle.
function lineOf(shutter, x, y) {
  const column = DATA.crop[0] + (x + 0.5) * DATA.factor - 0.5, row = DATA.crop[2] + (y + 0.5) * DATA.factor - 0.5;
  switch (shutter.side) {
    case 'top': return row;
    case 'bottom': return DATA.frame[1] - 1 - row;
    case 'left': return column;
    case 'right': return DATA.frame[0] - 1 - column;
    default: return 0;
  }
}

function interval(shutter, line) {
  const late = shutter.side === 'none' ? 0 : shutter.readout * line / lineCount(shutter);
  return [shutter.open + (shutter.reset ? 0 : late), shutter.close + late];
}

// The weight of a line, of integral 1: straight parts of [begin, end, weight at begin, at end].
function weightOf(shutter, line) {
  const [open, close] = interval(shutter, line), length = close - open;
  const a = open + shutter.rise * length, b = open + shutter.fall * length;
  const peak = 2 / (length * (1 + shutter.fall - shutter.rise));
  return [[open, a, 0, peak], [a, b, peak, peak], [b, close, peak, 0]].filter((part) => part[1] > part[0]);
}

// ---- as the command line has it

function number(value, digits) { return String(Number(value.toFixed(digits))); }
function frames(time) { return number((DATA.open + time * WINDOW) * DATA.fps, 4); }

function curveOf(shutter) {
  if (shutter.rise <= 0.005 && shutter.fall >= 0.995) return 'box';
  if (Math.abs(shutter.rise - 0.5) < 0.005 && Math.abs(shutter.fall - 0.5) < 0.005) return 'triangle';
  return `trapezoid:${number(shutter.rise, 3)},${number(shutter.fall, 3)}`;
}

function quoted(name) { return /^[\w.][\w.-]*$/.test(name) ? name : `'${name.replaceAll("'", "'\\''")}'`; }

function commandOf(shutter, view, exposure) {
  let text = `kairos expose ${quoted(DATA.file)} -o picture.png --shutter ${frames(shutter.open)},${frames(shutter.close)}`;
  if (curveOf(shutter) !== 'box') text += ` --curve ${curveOf(shutter)}`;
  if (shutter.side !== 'none') text += ` --rolling ${shutter.side}:${number(shutter.readout * WINDOW * 1000, 3)}ms${shutter.reset ? ':reset' : ''}`;
  if (view !== DATA.view) text += ` --view ${view}`;
  if (exposure !== 0) text += ` --exposure ${number(exposure, 1)}`;
  return text;
}

function saysOf(shutter) {
  const length = (shutter.close - shutter.open) * WINDOW, ms = (seconds) => `${number(seconds * 1000, 2)} ms`;
  let text = `${shutter.side === 'none' ? 'Every pixel' : 'Each line'} is exposed for ${ms(length)}, ${number(length * DATA.fps, 3)} ` +
    `frame${Math.abs(length * DATA.fps - 1) < 1e-3 ? '' : 's'}, ${number(length * DATA.fps * 360, 1)}°`;
  if (shutter.side !== 'none') {
    const lines = lineCount(shutter), each = shutter.readout * WINDOW / lines * 1e6;
    text += shutter.reset ? ` and more: ${lines} lines open together and close one after the other, from the ${shutter.side}, ${number(each, 2)} µs apart` :
      `: ${lines} lines one after the other, from the ${shutter.side}, ${number(each, 2)} µs apart`;
  }
  return text + '.';
}
