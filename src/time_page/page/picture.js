// Exposing: the integral of what each pixel shows times the weight of its line, in closed form; and how a screen shows it.

// Adds the integral of a pixel's pieces times one part of a weight to out[at] and the two behind it.
function addIntegral(signals, pixel, part, out, at) {
  const {first, begin, left, step} = signals, last = first[pixel + 1];
  const [from, to, weightFrom, weightTo] = part, slope = (weightTo - weightFrom) / (to - from);
  let i = first[pixel];
  while (i + 1 < last && begin[i + 1] <= from) ++i;
  for (; i < last && (begin[i] < to || i === first[pixel]); ++i) {
    const start = begin[i], end = i + 1 < last ? begin[i + 1] : 1;
    const a = Math.max(start, from), b = Math.min(end, to), length = b - a;
    if (!(length > 0)) continue;
    const atA = weightFrom + (a - from) * slope, atB = weightFrom + (b - from) * slope;
    const placeA = (a - start) / (end - start), placeB = (b - start) / (end - start);
    const weight = length * (atA + atB) / 2, moment = length * (placeA * (2 * atA + atB) + placeB * (atA + 2 * atB)) / 6;
    for (let c = 0; c < 3; ++c) out[at + c] += left[3 * i + c] * weight + step[3 * i + c] * moment;
  }
}

// Linear red, green and blue: [3 * pixel + channel].
function exposed(signals, shutter) {
  const out = new Float32Array(3 * PIXELS), {width, height} = DATA;
  const alongX = shutter.side === 'left' || shutter.side === 'right';
  const weights = Array.from({length: alongX ? width : height}, (_, i) =>
    weightOf(shutter, alongX ? lineOf(shutter, i, 0) : lineOf(shutter, 0, i)));
  for (let y = 0, pixel = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, ++pixel)
      for (const part of weights[alongX ? x : y]) addIntegral(signals, pixel, part, out, 3 * pixel);
  return out;
}

const CODES = 16384;
const SRGB = Uint8Array.from({length: CODES + 1}, (_, i) => {
  const linear = i / CODES;
  return Math.round(255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055));
});

// Puts the colours of a screen into rgba: docs/light.md, "View".
function show(colours, view, stops, rgba) {
  const scale = 2 ** stops, shoulder = 0.7, room = 1 - shoulder, halfPale = 6;
  for (let i = 0, o = 0; i < colours.length; i += 3, o += 4) {
    let r = Math.max(0, colours[i]) * scale, g = Math.max(0, colours[i + 1]) * scale, b = Math.max(0, colours[i + 2]) * scale;
    const peak = Math.max(r, g, b);
    if (view === 'filmic' && peak > shoulder) {
      const shown = 1 - room * room / (peak - shoulder + room), pale = (peak - shown) / (peak - shown + halfPale), keep = shown / peak * (1 - pale);
      r = r * keep + shown * pale; g = g * keep + shown * pale; b = b * keep + shown * pale;
    }
    rgba[o] = SRGB[Math.round(Math.min(1, r) * CODES)];
    rgba[o + 1] = SRGB[Math.round(Math.min(1, g) * CODES)];
    rgba[o + 2] = SRGB[Math.round(Math.min(1, b) * CODES)];
    rgba[o + 3] = 255;
  }
}
