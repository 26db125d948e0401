"""Uses the page of kairos expose in headless Chromium: what is dragged there is what kairos expose makes of the page's command.

Usage: shutter_page.py KAIROS SCENE [--screenshot FILE WIDTH HEIGHT]...
       shutter_page.py --page PAGE [--screenshot FILE WIDTH HEIGHT]...

The second form only looks at a page that is there. Ends with status 77 when there is no Chromium, or 1 if KAIROS_NEED_TOOLS
is set.
"""

import base64
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

from browser import Browser, find_chromium

WIDE, NARROW = (1200, 900), (390, 800)
MOST = 0.013  # of linear light: the page's tolerance, and the rounding of both pictures to 8 bits

# How far the page's picture is from another one, linear; without the mark on it.
DIFFERENCE = """(() => {
  const other = document.createElement('canvas');
  other.width = DATA.width; other.height = DATA.height;
  const ink = other.getContext('2d');
  ink.drawImage(window.reference, 0, 0);
  const a = ink.getImageData(0, 0, DATA.width, DATA.height).data, b = image.data;
  const linear = (code) => code <= 10 ? code / 255 / 12.92 : ((code / 255 + 0.055) / 1.055) ** 2.4;
  let most = 0, brightest = 0;
  for (let i = 0; i < a.length; ++i) {
    most = Math.max(most, Math.abs(linear(a[i]) - linear(b[i])));
    if (i % 4 < 3) brightest = Math.max(brightest, b[i]);
  }
  return brightest > 50 ? most : 1;
})()"""


def centre(browser, handle, share):
    """Where a handle's element lies: `share` of the way down."""
    return browser.value(f"(() => {{ const r = [...document.querySelectorAll('[data-handle={handle}]')].at(-1).getBoundingClientRect();"
                         f"return [r.left + r.width / 2, r.top + {share} * r.height]; }})()")


def drag(browser, handle, by, share=0.5):
    """Moves a handle by a part of the recorded time, with a real mouse."""
    x, y = centre(browser, handle, share)
    step = by * browser.value("diagram.width")
    browser.mouse("mousePressed", x, y, 1)
    browser.mouse("mouseMoved", x + step / 2, y, 1)
    browser.mouse("mouseMoved", x + step, y, 1)
    browser.mouse("mouseReleased", x + step, y, 0)
    browser.wait("!stale", "the page does not draw")


def check(browser, url, kairos, folder):
    problems = []

    def compare(what):
        command = shlex.split(browser.value("document.getElementById('command').textContent"))
        subprocess.run([kairos, *command[1:], "--quiet"], cwd=folder, check=True)
        picture = base64.b64encode((folder / "picture.png").read_bytes()).decode()
        browser.value(f"window.reference = new Image(); window.reference.src = 'data:image/png;base64,{picture}'; 0")
        browser.wait("window.reference.complete && window.reference.width === DATA.width", "the picture does not load")
        difference = browser.value(DIFFERENCE)
        print(f"{what}: {difference:.4f} from {' '.join(command)}")
        if not difference < MOST:
            problems.append(f"{what}: the page's picture is {difference} from that of {' '.join(command)}")
        return command

    def click(name):
        browser.value(f"[...document.querySelectorAll('button')].find((b) => b.textContent === '{name}').click()")
        browser.wait("!stale", "the page does not draw")

    for size in (WIDE, NARROW):
        browser.open(url, size)
        browser.wait("document.body.dataset.ready === 'yes'", "the page does not come to be ready")
        if browser.value("document.documentElement.scrollWidth") > size[0]:
            problems.append(f"the page is wider than {size[0]} pixels")
    browser.open(url, WIDE)
    browser.wait("document.body.dataset.ready === 'yes'", "the page does not come to be ready")
    compare("as it opens")
    drag(browser, "open", 0.25)
    drag(browser, "close", 0.05)
    command = compare("a part")
    begin, end = map(float, command[command.index("--shutter") + 1].split(","))
    if abs(begin - 0.5) > 0.01 or abs(end - 0.8) > 0.01:
        problems.append(f"dragged to {begin} and {end}, not 0.5 and 0.8")
    drag(browser, "rise", 0.1)
    if "--curve" not in compare("a curve"):
        problems.append("the curve was not dragged")
    drag(browser, "move", -0.4)
    compare("earlier")
    for side in ("top", "left", "right"):
        click("all of it")
        click(f"from the {side}")
        if side == "top":
            before = browser.value("state.shutter.readout")
            drag(browser, "readout", -0.3)
            if abs(before - browser.value("state.shutter.readout") - 0.3) > 0.02:
                problems.append("the time of reading all lines was not dragged")
        if "--rolling" not in compare(f"rolling from the {side}"):
            problems.append(f"nothing rolls from the {side}")
    browser.value("document.getElementById('reset').click()")
    browser.wait("!stale", "the page does not draw")
    compare("global reset")
    browser.value("document.getElementById('view').value = 'filmic'; document.getElementById('view').dispatchEvent(new Event('change'))")
    browser.wait("!stale", "the page does not draw")
    compare("filmic")
    return problems + browser.errors


def code_of(page):
    """All of a page but the picture that it holds."""
    return re.sub(r'(<script type="application/json" id="data">).*?</script>', r"\1", page.read_text(), flags=re.DOTALL)


def main():
    arguments = sys.argv[1:]
    made = arguments[0] != "--page"
    browser = Browser(find_chromium())
    try:
        with tempfile.TemporaryDirectory(prefix="kairos_page_") as name:
            folder = pathlib.Path(name)
            page = folder / "page.html" if made else pathlib.Path(arguments[1]).resolve()
            problems = []
            if made:
                kairos, scene = arguments[:2]
                subprocess.run([kairos, "render", scene, "--quiet", "--time", folder / "shot file.ktime", "--size", "96x54", "--frame", "24",
                                "--shutter", "0,1", "--tc-rays", "4", "--shading", "flat", "--time-tolerance", "exact"], check=True)
                subprocess.run([kairos, "expose", folder / "shot file.ktime", "--quiet", "--page", page], check=True)
                problems = check(browser, page.as_uri(), kairos, folder)
                in_docs = pathlib.Path(__file__).parents[2] / "docs/pictures/shutter.html"
                if code_of(in_docs) != code_of(page):
                    problems.append(f"{in_docs} is not what kairos expose --page writes: make it anew")
            for i in range(2, len(arguments), 4):
                browser.open(page.as_uri(), (int(arguments[i + 2]), int(arguments[i + 3])))
                browser.wait("document.body.dataset.ready === 'yes'", "the page does not come to be ready")
                browser.screenshot(arguments[i + 1])
    finally:
        browser.close()
    sys.exit("\n".join(problems) if problems else 0)


main()
