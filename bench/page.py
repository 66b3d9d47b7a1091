"""``python -m bench.page``: how soon the page is there, and how soon its numbers follow a slider.

On a service of its own, in Debian's chromium with WebGL by software. Times are those of the page's
own clock, in ms; on a machine with other work only the best of them mean something.
"""

from __future__ import annotations

import gzip
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from urllib.request import urlopen

from playwright.sync_api import Browser, Page, sync_playwright

STATIC = Path(__file__).parents[1] / "app" / "static"
PORT = 8917
ROBOTS = {"planar_2r": 2, "puma560": 6, "panda": 7, "planar_8r": 8}
LOADS, MOVES = 7, 60
FLAGS = (
    "--headless=new --no-sandbox --use-gl=angle --use-angle=swiftshader"
    " --enable-unsafe-swiftshader --disable-background-networking"
)
WATCH = """new MutationObserver(() => {
    const cell = document.querySelector('#section-jacobian .matrix td[data-value]');
    if (cell && !window.numbersAfter) window.numbersAfter = performance.now();
    const probe = document.querySelector('.host')?.probe;
    if (probe && !window.viewAfter) window.viewAfter = performance.now();
}).observe(document, {subtree: true, childList: true, attributes: true});"""
FOLLOW = """async (count) => {
    const slider = document.querySelector('.joint input[type=range]');
    const cells = ['jacobian', 'pose'].map((one) =>
        document.querySelector(`#section-${one} .matrix td[data-value]`));
    const shown = () => cells.map((one) => one.dataset.value);
    const times = [];
    for (let k = 1; k <= count; k += 1) {
        const before = shown();
        const begun = performance.now();
        slider.value = String(k % 2 ? 3 + k / 7 : -3 - k / 7);
        slider.dispatchEvent(new Event('input', {bubbles: true}));
        while (shown().some((one, i) => one === before[i])) {
            if (performance.now() - begun > 5000) throw new Error('no numbers came');
            await new Promise((done) => setTimeout(done, 1));
        }
        times.push(performance.now() - begun);
        await new Promise((done) => setTimeout(done, 30));
    }
    return times;
}"""


def loads(browser: Browser, address: str) -> tuple[list[float], list[float]]:
    """Times to the first numbers and to the 3D view, each with an empty cache."""
    numbers, views = [], []
    for _ in range(LOADS):
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        page = context.new_page()
        page.add_init_script(WATCH)
        page.goto(f"{address}/#robot=puma560&q=0,45,-90,0,45,0")
        page.wait_for_function("() => window.numbersAfter && window.viewAfter")
        numbers.append(float(page.evaluate("() => window.numbersAfter")))
        views.append(float(page.evaluate("() => window.viewAfter")))
        context.close()
    return numbers, views


def follows(page: Page, address: str, robot: str, dof: int) -> list[float]:
    """Times from a slider's event to the pose and Jacobian of the new posture."""
    page.goto("about:blank")
    page.goto(f"{address}/#robot={robot}&q={','.join(['10'] * dof)}")
    page.wait_for_selector("#section-singularity .facts dd")
    page.wait_for_load_state("networkidle")
    return [float(one) for one in page.evaluate(FOLLOW, MOVES)]


def first_screen() -> dict[str, int]:
    """Bytes of JavaScript, gzipped, until the first numbers are there, by language."""
    index = (STATIC / "index.html").read_text()
    scripts = {*re.findall(r"assets/[\w-]+\.js", index)}
    found = {}
    for language in ("en", "fr"):
        words = {f"assets/{one.name}" for one in (STATIC / "assets").glob(f"{language}-*.js")}
        files = [STATIC / one for one in scripts | words]
        found[language] = sum(len(gzip.compress(one.read_bytes(), 9)) for one in files)
    return found


def told(what: str, times: list[float]) -> None:
    """Prints a line of times."""
    low, middle, high = min(times), statistics.median(times), max(times)
    print(f"  {what:28} median {middle:7.1f}  best {low:7.1f}  worst {high:7.1f}  ({len(times)}x)")


def main() -> None:
    """Starts a service and a browser, and prints what they take."""
    chromium = shutil.which("chromium")
    if chromium is None:
        sys.exit("bench.page needs chromium on PATH (Debian: apt-get install chromium)")
    address = f"http://127.0.0.1:{PORT}"
    with tempfile.TemporaryDirectory() as folder:
        command = [str(Path(sys.executable).parent / "denavit"), "serve", "--port", str(PORT)]
        service = subprocess.Popen([*command, "--data-dir", folder, "--log-level", "warning"])
        try:
            _wait(f"{address}/health/ready", service)
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(
                    executable_path=chromium, args=FLAGS.split(" ")
                )
                print(f"first screen, bytes of JavaScript gzipped: {first_screen()}")
                numbers, views = loads(browser, address)
                print("ms until, with an empty cache")
                told("first numbers", numbers)
                told("the 3D view", views)
                print("ms from a slider to pose and Jacobian")
                page = browser.new_page()
                for robot, dof in ROBOTS.items():
                    told(robot, follows(page, address, robot, dof))
                browser.close()
        finally:
            service.terminate()
            service.wait()


def _wait(address: str, service: subprocess.Popen[bytes]) -> None:
    deadline = time.monotonic() + 180
    while time.monotonic() < deadline and service.poll() is None:
        try:
            with urlopen(address):
                return
        except OSError:
            time.sleep(0.1)
    sys.exit("the service did not start")


if __name__ == "__main__":
    main()
