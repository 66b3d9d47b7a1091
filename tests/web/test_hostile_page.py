"""Pages of strangers in a real browser: nothing of the service is changed, nothing is read.

A page of another origin tries every way in which a page can send or embed; another one gives its
own name the address of this machine (DNS rebinding). What they try works on a service that has no
doors: each test shows that first, on a decoy.
"""

from __future__ import annotations

import hashlib
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import httpx
import pytest
from playwright.sync_api import Frame, Page

from tests.app.conftest import Server, served
from tests.conftest import DENAVIT, PATIENCE

STRANGER = "evil.example"
FLAGS = (
    "--disable-gpu --disable-features=LocalNetworkAccessChecks"
    f" '--host-resolver-rules=MAP {STRANGER} 127.0.0.1'"
)
"""Without the browser's own doors to this machine: those of the service are tested."""
SECRET = 0.736251
MINE = {
    "name": "mine",
    "convention": "standard",
    "joints": [{"type": "R", "alpha": 0, "a": SECRET, "d": 0}],
}
ORIGINS = ("127.0.0.1", "localhost", STRANGER, "null")
QUESTIONS = (
    "/",
    "/v1/robots",
    "/v1/robots/mine",
    "/v1/robots/mine/dh",
    "/v1/robots/mine/urdf",
    "/v1/robots/mine/fk?q=0",
    "/v1/robots/mine/fk?q=0&format=text",
    "/v1/robots/mine/picture.svg?q=0",
    "/health/live",
    "/health/ready",
    "/openapi.json",
    "/metrics",
    "/docs",
    "/guide",
)

SEND = """async ([victim, table, questions]) => {
    const forged = JSON.stringify({...table, name: 'forged'});
    const types = ['text/plain', 'application/json', 'application/x-www-form-urlencoded'];
    const changes = types.flatMap(type => [
        ['POST', '/v1/robots', type], ['PUT', '/v1/robots/forged', type],
        ['PUT', '/v1/robots/mine', type], ['DELETE', '/v1/robots/mine', type],
        ['PUT', '/v1/robots/mine?overwrite=true', type],
        ['POST', '/v1/robots?overwrite=true', type], ['POST', '/v1/fk', type],
    ]);
    const read = [];
    const ask = async (path, options) => {
        try {
            const answer = await fetch(victim + path, options);
            const text = await answer.text();
            if (answer.type !== 'opaque' && options.mode === 'cors') {
                read.push([options.method, path, answer.status, text]);
            }
        } catch { /* refused by the browser */ }
    };
    for (const mode of ['cors', 'no-cors']) {
        for (const path of questions) await ask(path, {method: 'GET', mode});
        for (const [method, path, type] of changes) {
            await ask(path, {method, mode, body: forged, headers: {'Content-Type': type}});
        }
    }
    const blobs = types.map(type => new Blob([forged], {type}));
    for (const body of [forged, new URLSearchParams({name: 'forged'}), ...blobs]) {
        try { navigator.sendBeacon(victim + '/v1/robots', body); } catch { /* refused */ }
    }
    for (const method of ['POST', 'PUT', 'DELETE']) {
        await new Promise(done => {
            const request = new XMLHttpRequest();
            request.onloadend = () => {
                const {status, responseText} = request;
                if (status) read.push([method, 'xhr', status, responseText]);
                done();
            };
            request.open(method, victim + '/v1/robots' + (method === 'POST' ? '' : '/mine'));
            request.setRequestHeader('Content-Type', 'text/plain');
            request.send(forged);
        });
    }
    for (const enctype of
            ['text/plain', 'application/x-www-form-urlencoded', 'multipart/form-data']) {
        await new Promise(done => {
            const frame = document.createElement('iframe');
            frame.name = 'f' + Math.random();
            document.body.append(frame);
            const form = document.createElement('form');
            Object.assign(form, {action: victim + '/v1/robots', method: 'post', enctype,
                target: frame.name});
            const field = document.createElement('input');
            // As text/plain this is sent as JSON, with one more field.
            Object.assign(field, {name: forged.slice(0, -1) + ',"title":"', value: '"}'});
            form.append(field);
            document.body.append(form);
            form.submit();
            setTimeout(done, 300);
        });
    }
    await Promise.all(['/v1/robots', '/v1/robots/mine/live'].map(path => new Promise(done => {
        try {
            const socket = new WebSocket(victim.replace('http', 'ws') + path);
            socket.onopen = () => socket.send(forged);
            socket.onmessage = event => read.push(['WebSocket', path, 200, String(event.data)]);
            socket.onclose = done;
        } catch { done(); }
        setTimeout(done, 1000);
    })));
    await new Promise(done => {
        const source = new EventSource(victim + '/v1/robots');
        source.onmessage = event => read.push(['EventSource', '', 200, String(event.data)]);
        source.onerror = () => { source.close(); done(); };
    });
    return read;
}"""
"""Tries to change and to read; returns what could be read."""

EMBED = """async ([victim, id]) => {
    const root = victim + '/v1/robots/' + id;
    const rules = element => {
        try { return element.sheet?.cssRules.length ?? 0; } catch { return 'hidden'; }
    };
    const outcome = async (name, attributes) => {
        const element = document.createElement(name);
        const before = Object.keys(window).length;
        let error = '';
        window.onerror = (...given) => { error = String(given[0]); return true; };
        const event = await new Promise(done => {
            element.onload = () => done('load');
            element.onloadedmetadata = () => done('metadata');
            element.onerror = () => done('error');
            setTimeout(() => done('nothing'), 5000);
            Object.assign(element, attributes);
            document.body.append(element);
        });
        let inside = 'no access';
        try {
            const text = element.contentDocument?.body?.innerText;
            inside = text ? text.replaceAll(id, 'ID') : 'nothing';
        } catch { /* of another origin */ }
        const found = [name, event, element.naturalWidth ?? 0, element.naturalHeight ?? 0,
            Object.keys(window).length - before, error, inside,
            element.contentWindow?.length ?? 0, rules(element)];
        element.remove();
        return found.join(' ');
    };
    const found = [];
    for (const path of ['/dh', '/urdf', '/fk?q=0&format=text', '/picture.svg?q=0']) {
        found.push(await outcome('img', {src: root + path}));
        found.push(await outcome('img', {src: root + path, crossOrigin: 'anonymous'}));
        found.push(await outcome('script', {src: root + path}));
        found.push(await outcome('script', {src: root + path, type: 'module'}));
        found.push(await outcome('link', {href: root + path, rel: 'stylesheet'}));
        found.push(await outcome('iframe', {src: root + path}));
        found.push(await outcome('object', {data: root + path}));
        found.push(await outcome('video', {src: root + path}));
        for (const mode of ['cors', 'no-cors']) {
            const told = await fetch(root + path, {mode}).then(
                answer => `${answer.type} ${answer.status}`, () => 'refused');
            found.push(`${mode} ${told}`);
        }
    }
    return found;
}"""
"""Embeds what there is of a robot; returns all that a page can see of it."""

OPEN = """async ([victim, table]) => {
    const told = [];
    addEventListener('message', event => told.push(JSON.stringify(event.data)));
    const opened = window.open(victim + '/#robot=mine&q=0');
    await new Promise(done => setTimeout(done, 3000));
    if (opened === null) return {told, document: null, isHeld: false};
    const change = {method: 'PUT', path: '/v1/robots/mine'};
    for (const message of [{type: 'save', table}, 'save', change]) {
        opened.postMessage(message, '*');
    }
    await new Promise(done => setTimeout(done, 500));
    let text = null;
    try { text = opened.document.body.innerText; } catch { /* of another origin */ }
    const isHeld = !opened.closed;
    opened.close();
    return {told, document: text, isHeld};
}"""


class _NoDoors(BaseHTTPRequestHandler):
    """Answers everything to everybody, and keeps what it was asked."""

    protocol_version = "HTTP/1.1"

    def _answer(self) -> None:
        length = int(self.headers.get("Content-Length") or 0)
        body = self.rfile.read(length)
        self.server.asked.append((self.command, self.path, body))  # type: ignore[attr-defined]
        text = b"<!doctype html><title>page</title><body>secret"
        self.send_response(404 if "absent" in self.path else 200)
        self.send_header("Content-Type", "text/html")
        for name in ("Origin", "Methods", "Headers"):
            self.send_header(f"Access-Control-Allow-{name}", "*")
        for method in ("PUT", "DELETE"):
            self.send_header("Access-Control-Allow-Methods", method)
        self.send_header("Content-Length", str(len(text)))
        self.end_headers()
        self.wfile.write(text)

    do_GET = do_POST = do_PUT = do_DELETE = do_OPTIONS = _answer  # noqa: N815  as the base class has it

    def log_message(self, *_: object) -> None:
        """Says nothing."""


@contextmanager
def without_doors() -> Iterator[ThreadingHTTPServer]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), _NoDoors)
    server.asked = []  # type: ignore[attr-defined]
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        server.server_close()


@pytest.fixture(scope="module")
def victim(tmp_path_factory) -> Iterator[Server]:
    """A service as it comes, with a robot."""
    folder = tmp_path_factory.mktemp("victim")
    with served(folder, program=DENAVIT, allowed_hosts="") as server:
        httpx.put(f"{server.address}/v1/robots/mine", json=MINE).raise_for_status()
        yield server


@pytest.fixture(scope="module")
def stranger() -> Iterator[ThreadingHTTPServer]:
    """Serves the pages of the stranger."""
    with without_doors() as server:
        yield server


@pytest.fixture
def page(browsers) -> Iterator[Page]:
    context = browsers(FLAGS).new_context()
    context.set_default_timeout(1000 * PATIENCE)
    yield context.new_page()
    context.close()


def kept(server: Server) -> tuple[object, dict[str, str]]:
    """All that is stored: the list, the robot, and each file on the disk."""
    folder = server.gate.parent / "data"
    files = {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
    assert any("mine" in name for name in files), files
    listed = httpx.get(f"{server.address}/v1/robots?page_size=1000", timeout=PATIENCE).json()
    mine = httpx.get(f"{server.address}/v1/robots/mine/dh", timeout=PATIENCE).json()
    return (listed, mine), files


def at(page: Page, host: str, port: int) -> Page | Frame:
    """Opens a page of the stranger at a name; "null": in a frame that has no origin."""
    page.goto(f"http://{STRANGER if host == 'null' else host}:{port}/")
    if host != "null":
        return page
    page.evaluate(
        """() => { const frame = document.createElement('iframe');
        frame.sandbox = 'allow-scripts allow-forms allow-popups';
        frame.srcdoc = '<!doctype html><body>';
        document.body.append(frame);
        return new Promise(done => { frame.onload = done; }); }"""
    )
    return page.frames[1]


@pytest.mark.parametrize("host", ORIGINS)
def test_a_page_of_another_origin_changes_and_reads_nothing(host, victim, stranger, page):
    before = kept(victim)
    hostile = at(page, host, stranger.server_port)
    given = [MINE, list(QUESTIONS)]
    with without_doors() as decoy:
        read = hostile.evaluate(SEND, [f"http://127.0.0.1:{decoy.server_port}", *given])
        assert read, "what the page tries does not read even where there is no door"
        sent = {(method, path) for method, path, body in decoy.asked if b"forged" in body}  # type: ignore[attr-defined]
        assert {("POST", "/v1/robots"), ("PUT", "/v1/robots/mine")} <= sent
    read = hostile.evaluate(SEND, [victim.address, *given])
    assert read == []
    assert kept(victim) == before
    refused = victim.counted("denavit_http_requests_total", method="POST", status_class="4xx")
    assert refused > 0, "the requests did not come"


@pytest.mark.parametrize("host", ORIGINS)
def test_what_a_page_embeds_tells_it_nothing(host, victim, stranger, page):
    hostile = at(page, host, stranger.server_port)
    with without_doors() as decoy:
        address = f"http://127.0.0.1:{decoy.server_port}"
        found = [hostile.evaluate(EMBED, [address, name]) for name in ("mine", "absent")]
        assert found[0] != found[1], "not even an open service tells the page anything"
    there, absent = (hostile.evaluate(EMBED, [victim.address, name]) for name in ("mine", "absent"))
    assert there == absent


@pytest.mark.parametrize("path", ["/", "/docs", "/guide", "/guide/api", "/v1/robots", "/nothing"])
def test_no_page_frames_the_service(path, victim, stranger, page):
    page.goto(f"http://127.0.0.1:{stranger.server_port}/")
    for address, shown in (
        (f"http://{STRANGER}:{stranger.server_port}", True),
        (victim.address, False),
    ):
        for name in ("iframe", "object", "embed"):
            page.evaluate(
                """([name, url]) => new Promise(done => {
                    document.body.replaceChildren();
                    const element = document.createElement(name);
                    element[name === 'object' ? 'data' : 'src'] = url;
                    element.onload = element.onerror = done;
                    setTimeout(done, 1500);
                    document.body.append(element);
                })""",
                [name, address + path],
            )
            inside = [frame for frame in page.frames[1:] if frame.url == address + path]
            assert bool(inside) == shown, (name, [frame.url for frame in page.frames])


@pytest.mark.parametrize("host", ORIGINS)
def test_a_page_that_opens_the_service_has_no_hold_on_it(host, victim, stranger, page):
    before = kept(victim)
    hostile = at(page, host, stranger.server_port)
    open_page = f"http://{STRANGER}:{stranger.server_port}"
    assert hostile.evaluate(OPEN, [open_page, MINE])["isHeld"]
    found = hostile.evaluate(OPEN, [victim.address, MINE])
    assert found == {"told": [], "document": None, "isHeld": False}
    assert kept(victim) == before


def test_a_rebound_name_changes_and_reads_nothing(victim, page):
    before = kept(victim)
    own = f"http://{STRANGER}:{victim.port}"
    # The stranger's server gave the page; then its name was given the address of this machine.
    page.route(f"{own}/attack", lambda route: route.fulfill(body="<!doctype html><body>"))
    page.goto(f"{own}/attack")
    read = page.evaluate(SEND, [own, MINE, list(QUESTIONS)])
    assert len(read) > len(QUESTIONS)
    assert {status for _, _, status, _ in read} == {421}
    told = json.dumps(read)
    assert str(SECRET) not in told
    assert "puma560" not in told
    # By the right name it is of another origin again.
    assert page.evaluate(SEND, [victim.address, MINE, list(QUESTIONS)]) == []
    there, absent = (page.evaluate(EMBED, [own, name]) for name in ("mine", "absent"))
    assert there == absent
    opened = page.evaluate(OPEN, [own, MINE])
    assert opened["told"] == []
    assert "421" in (opened["document"] or "421")
    assert kept(victim) == before
