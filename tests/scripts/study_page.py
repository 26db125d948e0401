"""Opens a study's page in headless Chromium and uses it: lines, sliders, pictures.

Usage: study_page.py PAGE [--screenshot FILE WIDTH HEIGHT TOP]...

A screenshot is of a window of that size in pixels, with the page scrolled down to TOP.

Fails on any script error, on anything that the page's own #self-test finds wrong, in a wide and in a narrow window, and when a
real mouse cannot drag the divider. Ends with status 77 when there is no Chromium, or 1 if KAIROS_NEED_TOOLS is set.
"""

import pathlib
import sys
import time

from browser import Browser, find_chromium

WIDE, NARROW = (1200, 900), (390, 800)


def check(browser, url):
    problems = []
    for size in (WIDE, NARROW):
        browser.open(url + "#self-test", size)
        browser.wait("document.getElementById('self-test') !== null", "the page's self-test does not end")
        verdict = browser.value("document.title")
        print(f"{size[0]} pixels wide: {verdict}")
        if not verdict.startswith("self-test passed"):
            problems.append(verdict)
    # With a real mouse.
    browser.open(url, WIDE)
    browser.value("document.querySelector('.slider').scrollIntoView({block: 'center'})")
    frame = browser.value("(() => { const r = document.querySelector('.slider').getBoundingClientRect();"
                          "return [r.left, r.top, r.width, r.height]; })()")
    at = [(frame[0] + share * frame[2], frame[1] + frame[3] / 2) for share in (0.5, 0.7, 0.9)]
    browser.mouse("mousePressed", *at[0], 1)
    browser.mouse("mouseMoved", *at[1], 1)
    browser.mouse("mouseMoved", *at[2], 1)
    browser.mouse("mouseReleased", *at[2], 0)
    place = browser.value("document.querySelector('.slider').getAttribute('aria-valuenow')")
    if place != "90":
        problems.append(f"the mouse dragged the divider to {place}, not 90")
    mark = browser.value("(() => { const mark = document.querySelector('.plot circle.hit'); mark.scrollIntoView({block: 'center'});"
                         "const r = mark.getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]; })()")
    browser.mouse("mouseMoved", *mark, 0)
    if browser.value("document.querySelector('.plot .tip').hidden"):
        problems.append("pointing at a mark shows nothing")
    return problems + browser.errors


def main():
    arguments = sys.argv[1:]
    url = pathlib.Path(arguments[0]).resolve().as_uri()
    browser = Browser(find_chromium())
    try:
        problems = check(browser, url)
        for i in range(1, len(arguments), 5):
            browser.open(url, (int(arguments[i + 2]), int(arguments[i + 3])))
            browser.value(f"window.scrollTo(0, {int(arguments[i + 4])})")
            time.sleep(0.5)
            browser.screenshot(arguments[i + 1])
    finally:
        browser.close()
    sys.exit("\n".join(problems) if problems else 0)


main()
