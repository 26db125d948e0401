// index.html#self-test: uses the page as a reader would, and says in the title and in #self-test what became of it.

const pageErrors = [];
window.addEventListener('error', (event) => pageErrors.push(event.message));
window.addEventListener('unhandledrejection', (event) => pageErrors.push(String(event.reason)));

async function testEntry(section, check) {
  const name = section.id;
  const buttons = [...section.querySelectorAll('.legend button')];
  check(buttons.length > 0, `${name}: no legend`);
  for (const button of buttons) {
    const groups = [...section.querySelectorAll('.plot g')].filter((g) => g.dataset.series === button.dataset.series);
    const shown = () => groups.length > 0 && groups.every((g) => getComputedStyle(g).display !== 'none');
    const before = shown();
    check(groups.length > 0, `${name}: no lines of ${button.dataset.series}`);
    check(before === (button.getAttribute('aria-pressed') === 'true'), `${name}: the legend is wrong about ${button.dataset.series}`);
    button.click();
    check(shown() === !before, `${name}: ${button.dataset.series} was not toggled`);
    button.click();
    check(shown() === before, `${name}: ${button.dataset.series} was not toggled back`);
  }
  for (const mark of section.querySelectorAll('.plot circle.hit')) {
    mark.dispatchEvent(new PointerEvent('pointerenter'));
    const tip = mark.closest('.plot').querySelector('.tip');
    check(!tip.hidden && tip.textContent.includes('PSNR') && !/NaN|undefined|null/.test(tip.textContent), `${name}: a mark's tip is wrong`);
    mark.dispatchEvent(new PointerEvent('pointerleave'));
    check(tip.hidden, `${name}: a tip remains`);
  }
  for (const path of section.querySelectorAll('.plot path'))
    check(!/NaN|Infinity|undefined/.test(path.getAttribute('d')), `${name}: a line is broken`);

  const slider = section.querySelector('.slider'), box = section.querySelector('.comparator');
  const frame = slider.getBoundingClientRect();
  const press = (type, share) => slider.dispatchEvent(new PointerEvent(type, {clientX: frame.left + share * frame.width, bubbles: true}));
  const place = () => Number(slider.getAttribute('aria-valuenow'));
  check(frame.width > 0 && frame.height > 0, `${name}: the slider has no size`);
  press('pointerdown', 0.25);
  check(place() === 25, `${name}: the divider is at ${place()}, not 25`);
  press('pointermove', 0.8);
  check(place() === 80, `${name}: the divider was not dragged`);
  press('pointerup', 0.8);
  press('pointermove', 0.1);
  check(place() === 80, `${name}: the divider was dragged without being held`);
  slider.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft'}));
  check(place() === 78, `${name}: the arrow key moved nothing`);
  check(section.querySelector('.slider canvas:nth-of-type(2)').style.clipPath.includes('22%'), `${name}: the left picture is not cut`);
  press('pointerdown', 0.5);
  press('pointerup', 0.5);

  const canvas = slider.querySelectorAll('canvas')[1], select = section.querySelector('select[data-side="left"]');
  const mode = section.querySelector('select[data-mode]');
  const content = () => canvas.toDataURL();
  const choose = async (element, value) => {
    element.value = value;
    element.dispatchEvent(new Event('change'));
    await box.ready;
  };
  await box.ready;
  const initial = [select.value, content()];
  await choose(select, '0');
  check(content() !== initial[1], `${name}: another picture was chosen, and nothing changed`);
  await choose(select, initial[0]);
  check(content() === initial[1], `${name}: the picture did not come back`);
  await choose(mode, 'error');
  check(content() !== initial[1], `${name}: no error map`);
  await choose(mode, 'picture');

  for (const button of section.querySelectorAll('.choice button')) {
    button.click();
    check(button.getAttribute('aria-pressed') === 'true', `${name}: ${button.textContent} was not chosen`);
  }
  for (const group of section.querySelectorAll('.choice')) group.querySelector('button').click();
  for (const image of section.querySelectorAll('.crops img')) {
    await image.decode();
    check(image.naturalWidth > 0, `${name}: an enlarged part is not shown`);
  }
  check(section.querySelectorAll('.comparisons table').length > 0 || section.querySelector('.comparisons') === null, `${name}: no comparison`);
  check(!/NaN|undefined|\[object/.test(section.innerText), `${name}: NaN or undefined in the text`);
}

async function selfTest() {
  let checks = 0;
  const failures = [];
  const check = (condition, message) => {
    ++checks;
    if (!condition) failures.push(message);
  };
  try {
    check(DATA.entries.length > 0, 'the page has no entries');
    for (const section of document.querySelectorAll('section.entry')) await testEntry(section, check);
    check(document.documentElement.scrollWidth <= window.innerWidth + 1, 'the page is wider than the window');
  } catch (error) {
    failures.push(String(error));
  }
  failures.push(...pageErrors);
  const verdict = failures.length === 0 ? `self-test passed: ${checks} checks` : `self-test failed: ${failures.join('; ')}`;
  document.title = verdict;
  document.body.append(make('div', {id: 'self-test'}, verdict));
}
