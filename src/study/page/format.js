'use strict';
// Elements, and numbers as text.

const SVG = 'http://www.w3.org/2000/svg';

// An element with attributes ("on..." are listeners) and children (texts or elements).
function make(tag, attributes = {}, ...children) {
  return furnish(document.createElement(tag), attributes, children);
}
function makeSvg(tag, attributes = {}, ...children) {
  return furnish(document.createElementNS(SVG, tag), attributes, children);
}
function furnish(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

// Three digits, without an exponent where that can be read.
function short(value) {
  if (value === null) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e9) return `${short(value / 1e9)} G`;
  if (size >= 1e6) return `${short(value / 1e6)} M`;
  if (size >= 1e4) return `${short(value / 1e3)} k`;
  if (size < 1e-3) return value.toExponential(1).replace('-', '−');
  return String(Number(value.toPrecision(3))).replace('-', '−');
}
function duration(seconds) {
  if (seconds === null) return '–';
  return seconds < 1 ? `${short(seconds * 1000)} ms` : `${short(seconds)} s`;
}
function fixed(value, digits) {
  return value === null ? '–' : value.toFixed(digits).replace('-', '−');
}
function signed(value, digits = 1) {
  return (value >= 0 ? '+' : '') + fixed(value, digits);
}
function count(value) {
  return value.toLocaleString('en-US').replaceAll(',', '\u202f');
}

// Colours that those who don't see red and green apart can tell (Okabe and Ito), with a shape each.
const LOOKS = {
  'random': {colour: '#8c8c8c', shape: 'cross'},
  'multi-jitter': {colour: '#e69f00', shape: 'diamond'},
  'owen-sobol': {colour: '#111111', shape: 'square'},
  'tc': {colour: '#0072b2', shape: 'circle'},
  'mixed': {colour: '#009e73', shape: 'triangle'},
  'auto': {colour: '#d55e00', shape: 'circle'},
};
// One number of rays over growing shading samples: a detail of tc.
function isDetail(name) {
  return /^tc-\d+$/.test(name);
}
function lookOf(name) {
  return LOOKS[name] || {colour: '#56b4e9', shape: 'circle', dash: '4 3', thin: true};
}
function marker(shape, x, y, colour, size = 4.5) {
  const path = {
    circle: `M${x - size},${y}a${size},${size} 0 1,0 ${2 * size},0a${size},${size} 0 1,0 ${-2 * size},0z`,
    square: `M${x - size},${y - size}h${2 * size}v${2 * size}h${-2 * size}z`,
    diamond: `M${x},${y - 1.3 * size}L${x + 1.3 * size},${y}L${x},${y + 1.3 * size}L${x - 1.3 * size},${y}z`,
    triangle: `M${x},${y - 1.2 * size}L${x + 1.2 * size},${y + size}L${x - 1.2 * size},${y + size}z`,
    cross: `M${x - size},${y - size}l${2 * size},${2 * size}M${x - size},${y + size}l${2 * size},${-2 * size}`,
  }[shape];
  return makeSvg('path', {d: path, fill: shape === 'cross' ? 'none' : colour, stroke: colour, 'stroke-width': 1.5});
}
