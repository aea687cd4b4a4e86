#!/usr/bin/env python3
"""Plays a page that the example `replay` wrote in a headless Chromium and looks at what it shows.

usage: recording_page.py PAGE.html [--screenshots FOLDER]

Needs the Python packages playwright and pillow, and a Chromium on the PATH; where one is missing it says so and ends
with status 0. Otherwise the status is 0 if and only if the page plays: no error on the console, nothing asked of the
network, a picture that is not blank, pictures of two times that differ, a clock that goes on while playing and stands
still when paused, spheres that look other than meshes, and a view that turns with the mouse.
"""
import io
import shutil
import sys
from pathlib import Path

try:
    from PIL import Image, ImageChops
    from playwright.sync_api import sync_playwright
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is not here (pip install playwright pillow)")
    sys.exit(0)

BROWSER = next(filter(None, map(shutil.which, ["chromium", "chromium-browser", "google-chrome"])), None)
# Without a graphics card WebGL is computed.
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
SIZE = {"width": 1280, "height": 720}
# Difference of two grey values that the eye notices side by side.
VISIBLE = 12
# The scene without heading and controls.
SCENE = (320, 20, 1260, 620)


def colors(picture):
    """Number of different colours in the scene's part of the picture, 32 steps a channel."""
    return len(picture.crop(SCENE).point(lambda value: value // 8).getcolors(1 << 15))


def difference(a, b):
    """Share of the scene's pixels that differ visibly."""
    gray = ImageChops.difference(a.crop(SCENE), b.crop(SCENE)).convert("L")
    return sum(gray.histogram()[VISIBLE:]) / (gray.width * gray.height)


def play(browser, page_file, folder):
    """Yields what is wrong with the page."""
    page = browser.new_page(viewport=SIZE)
    said, asked = [], []
    page.on("console", lambda message: said.append(message.text) if message.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))

    def shot(name):
        page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        data = page.screenshot()
        if folder:
            (folder / f"{name}.png").write_bytes(data)
        return Image.open(io.BytesIO(data)).convert("RGB")

    page.goto(page_file.resolve().as_uri())
    page.wait_for_function("() => window.player", timeout=120_000)
    duration = page.evaluate("() => player.duration")
    page.evaluate("() => { player.seek(0); player.play(); }")
    page.wait_for_function("() => player.time > 0", timeout=120_000)
    page.keyboard.press("Space")
    stopped = page.evaluate("() => [player.playing, player.time]")
    page.wait_for_timeout(300)
    if stopped != [False, page.evaluate("() => player.time")]:
        yield f"the space key does not pause: {stopped}"

    pictures = {}
    for name, share in [("start", 0.0), ("middle", 0.05), ("end", 1.0)]:
        page.evaluate("time => player.seek(time)", share * duration)
        pictures[name] = shot(name)
        if colors(pictures[name]) < 24:
            yield f"the picture of the {name} is blank: {colors(pictures[name])} colours"
    for a, b in [("start", "middle"), ("middle", "end")]:
        if difference(pictures[a], pictures[b]) < 0.01:
            yield f"{a} and {b} look the same"
    clock = page.inner_text("#clock")
    if f"{duration:.2f}" not in clock:
        yield f"the clock shows {clock!r} at the end, {duration:.2f} s"
    if page.is_visible("#spheres"):
        page.click("#spheres")
        pictures["spheres"] = shot("spheres")
        if difference(pictures["spheres"], pictures["end"]) < 0.005:
            yield "spheres look like meshes"
        page.click("#spheres")
    page.mouse.move(640, 300)
    page.mouse.down()
    page.mouse.move(860, 240, steps=4)
    page.mouse.up()
    turned = shot("turned")
    if difference(turned, pictures["end"]) < 0.01:
        yield "dragging does not turn the view"
    page.mouse.wheel(0, -400)
    page.wait_for_timeout(100)
    if difference(shot("near"), turned) < 0.01:
        yield "the wheel does not zoom"

    page.goto(page_file.resolve().as_uri() + "#t=0.5")
    page.reload()
    page.wait_for_function("() => window.player", timeout=120_000)
    asked_for = page.evaluate("() => [player.playing, player.time]")
    if asked_for != [False, min(0.5, duration)]:
        yield f"#t=0.5 opens at {asked_for}"
    yield from (f"console: {text}" for text in said)
    yield from (f"asked for {url}" for url in asked if not url.startswith(("file:", "data:")))


def main():
    page_file = Path(sys.argv[1])
    folder = Path(sys.argv[3]) if "--screenshots" in sys.argv else None
    if BROWSER is None:
        print("skipped: no Chromium is on the PATH")
        return 0
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=BROWSER, args=FLAGS)
        wrong = list(play(browser, page_file, folder))
        browser.close()
    print("\n".join(wrong) or "ok")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
