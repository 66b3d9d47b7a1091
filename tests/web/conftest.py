"""A real browser on a real server: Debian's chromium, WebGL by software."""

import importlib.util
import os
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from urllib.parse import urlsplit

import numpy as np
import pytest
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

from tests.conftest import PATIENCE, until

ROOT = Path(__file__).parents[2]
STATIC = ROOT / "app" / "static"
FLAGS = (
    "--headless=new --no-sandbox --disable-quic --no-first-run --disable-background-networking"
    " --disable-component-update --disable-sync"
)
WEBGL = "--use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader"
NO_WEBGL = "--disable-gpu --disable-3d-apis"


@pytest.fixture(scope="session")
def hook() -> ModuleType:
    """The build of the page, ``hatch_build.py``."""
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def axe(hook: ModuleType) -> str:
    """The source of axe-core, which finds what assistive technology cannot use."""
    hook.install_packages(ROOT / "web", development=True)
    return (ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js").read_text()


def chromium() -> str:
    """The browser's path; without one the tests are skipped, but in CI they fail."""
    found = next(
        (
            path
            for name in ("chromium", "chromium-browser", "google-chrome")
            if (path := shutil.which(name))
        ),
        None,
    )
    if found is None:
        reason = "the page's tests need chromium on PATH (Debian: apt-get install chromium)"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    if not (STATIC / "index.html").is_file():
        pytest.fail("the page is not built; run: make page")
    return found


@pytest.fixture(scope="module")
def browsers() -> Iterator[object]:
    """Starts a browser by its flags. Closed before other tests come: its loop runs until then."""
    executable = chromium()
    started: dict[str, Browser] = {}
    with sync_playwright() as playwright:

        def launch(flags: str) -> Browser:
            if flags not in started:
                started[flags] = playwright.chromium.launch(
                    executable_path=executable,
                    args=[*shlex.split(FLAGS), *shlex.split(flags)],
                    timeout=1000 * PATIENCE,
                )
            return started[flags]

        yield launch
        for browser in started.values():
            browser.close()


COUNT = """(() => {
    const real = window.fetch;
    let [pending, last] = [0, performance.now()];
    for (const kind of ['input', 'change', 'click', 'keydown', 'pointerup', 'hashchange']) {
        window.addEventListener(kind, () => { last = performance.now(); }, true);
    }
    window.fetch = async (...given) => {
        pending += 1;
        try {
            return await real(...given);
        } finally {
            pending -= 1;
            last = performance.now();
        }
    };
    window.isQuiet = () => pending === 0 && performance.now() - last > 300;
})()"""
"""Counts the requests under way; the browser's own "network idle" comes once a page only. What
the reader does may lead to requests a moment later: that is waited for too."""
DRAWN = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


class Visit:
    """A page of the service that is open in a browser."""

    def __init__(self, page: Page, server: str) -> None:
        self.page = page
        self.server = server

    def go(self, fragment: str = "") -> Page:
        """Opens the page with a hash, anew, and waits for the first numbers."""
        self.page.goto("about:blank")
        self.page.goto(f"{self.server}/#{fragment}")
        self.settled()
        return self.page

    def settled(self) -> None:
        """Waits until what is on the page belongs to the posture shown."""
        self.page.wait_for_selector("#section-pose .matrix td[data-value]", state="attached")
        self.page.wait_for_function("() => window.isQuiet()")

    def drawn(self) -> None:
        """Waits until what was changed is on the screen."""
        self.page.evaluate(DRAWN)

    def shows(self, section: str, expected: object) -> None:
        """Waits until a matrix of a section is this one."""
        until(lambda: np.array_equal(self.matrix(section), expected))

    def matrix(self, section: str) -> list[list[float]]:
        """A matrix of a section, as it was computed."""
        rows = self.page.locator(f"#section-{section} .matrix >> nth=0").locator("tbody tr")
        return [
            [
                float(value)
                for value in row.locator("td").evaluate_all(
                    "cells => cells.map(cell => cell.dataset.value)"
                )
            ]
            for row in rows.all()
        ]


@pytest.fixture
def open_page(browsers, server) -> Iterator[object]:
    """Opens the page; at the end nothing may have gone to another host or to the error console."""
    contexts: list[BrowserContext] = []
    wrong: list[str] = []

    def watch(page: Page, host: str) -> None:
        def asked(url: str) -> None:
            parts = urlsplit(url)
            if parts.scheme not in ("blob", "data", "about") and parts.netloc != host:
                wrong.append(f"asked another host: {url}")

        page.on("request", lambda request: asked(request.url))
        page.on("websocket", lambda socket: asked(socket.url))
        page.on("pageerror", lambda error: wrong.append(f"error: {error}"))
        page.on("console", said)

    expected: list[str] = []

    def said(message) -> None:
        # What the service refuses shows in the console, whether the page copes with it or not.
        if message.type == "error" and not any(text in message.text for text in expected):
            wrong.append(f"{message.type}: {message.text}")

    def opened(
        fragment: str | None = "",
        *,
        webgl: bool = True,
        address: str = server,
        refusals: bool = False,
        outages: bool = False,
        **options: object,
    ) -> Visit:
        expected.extend(["status of 4"] if refusals else [])
        expected.extend(["status of 503", "net::ERR_"] if outages else [])
        settings = {"viewport": {"width": 1440, "height": 900}, "locale": "en-GB", **options}
        context = browsers(WEBGL if webgl else NO_WEBGL).new_context(**settings)
        contexts.append(context)
        context.set_default_timeout(1000 * PATIENCE)
        page = context.new_page()
        page.add_init_script(COUNT)
        watch(page, urlsplit(address).netloc)
        visit = Visit(page, address)
        if fragment is not None:
            visit.go(fragment)
        return visit

    yield opened
    for context in contexts:
        context.close()
    assert not wrong, "\n".join(wrong)
