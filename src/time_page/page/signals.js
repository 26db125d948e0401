// What the pixels show over time: straight pieces, unpacked from the page's data.

const DATA = JSON.parse(document.getElementById('data').textContent);
const PIXELS = DATA.width * DATA.height, PIECES = DATA.pieces;

function fromHalf(half) {
  const exponent = (half >> 10) & 31, fraction = half & 1023;
  const value = exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15);
  return half & 0x8000 ? -value : value;
}

// {first: [pixel] of its pieces, begin: [piece], 0 to 1, left, step: [3 * piece + channel]}
async function unpackSignals() {
  const packed = Uint8Array.from(atob(DATA.packed), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let at = 0;
  const column = (count) => {
    const numbers = new Uint16Array(count);
    for (let i = 0; i < count; ++i) numbers[i] = bytes[at + i] | bytes[at + count + i] << 8;
    at += 2 * count;
    return numbers;
  };
  const counts = column(PIXELS), first = new Uint32Array(PIXELS + 1);
  for (let i = 0; i < PIXELS; ++i) first[i + 1] = first[i] + counts[i];
  const begin = Float64Array.from(column(PIECES), (tick) => tick / 65536);
  const halves = Float32Array.from({length: 65536}, (_, half) => fromHalf(half));
  const values = () => {
    const result = new Float32Array(3 * PIECES);
    for (let c = 0; c < 3; ++c) column(PIECES).forEach((half, i) => { result[3 * i + c] = halves[half]; });
    return result;
  };
  const left = values(), step = values();
  return {first, begin, left, step};
}
