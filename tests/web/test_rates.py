"""The page on a service that counts its requests, with the limit of docs/operate.md."""

import re
import threading
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from tests.app.conftest import Server, served
from tests.conftest import DENAVIT, PATIENCE, until

OPERATE = Path(__file__).parents[2] / "docs" / "operate.md"
SPAN = 1000
"""A second, ms."""
SENT = """(() => {
    const real = window.fetch;
    window.sentAt = [];
    window.fetch = (...given) => { window.sentAt.push(performance.now()); return real(...given); };
})()"""
SLIDE = """async (ms) => {
    const slider = document.querySelector('.joint input[type=range]');
    const begun = performance.now();
    let k = 0;
    while (performance.now() - begun < ms) {
        k += 1;
        slider.value = String(30 * Math.sin(k / 20));
        slider.dispatchEvent(new Event('input', {bubbles: true}));
        await new Promise(done => setTimeout(done, 8));
    }
    slider.value = '37';
    slider.dispatchEvent(new Event('input', {bubbles: true}));
    return begun;
}"""
HANDLE = "() => document.querySelector('.host').probe?.handle()"
ALL_OPEN = "open=pose,links,jacobian,singularity,ik,reproduce"


def documented() -> str:
    found = re.search(r"DENAVIT_RATE_LIMIT='([^']+)'", OPERATE.read_text())
    assert found
    return found[1]


@pytest.fixture(scope="module")
def counting(tmp_path_factory) -> Iterator[Server]:
    folder = tmp_path_factory.mktemp("counting")
    with served(folder, program=DENAVIT, rate_limit=documented()) as server:
        yield server


@pytest.fixture
def visit(open_page, counting):
    """Opens the page of the counting service; notes the statuses of its answers."""

    def opened(fragment: str, **options: object):
        found = open_page(None, address=counting.address, **options)
        found.page.add_init_script(SENT)
        found.statuses = []
        found.page.on("response", lambda answer: found.statuses.append(answer.status))
        found.go(fragment)
        return found

    return opened


def most_in_a_second(page, since: float = 0) -> int:
    """The most requests of any second, by the clock of the page."""
    times = [one for one in page.evaluate("() => window.sentAt") if one >= since]
    return max(sum(one <= other < one + SPAN for other in times) for one in times)


def shows_the_pose_of(page, server: Server, robot: str, q: list[float]) -> bool:
    query = {"q": ",".join(map(str, q)), "angle": "deg"}
    answer = httpx.get(f"{server.address}/v1/robots/{robot}/fk", params=query, timeout=PATIENCE)
    if answer.status_code == 429:
        return False
    (pose,) = answer.json()["poses"].values()
    shown = page.locator("#section-pose .matrix").first.locator("td[data-value]")
    values = shown.evaluate_all("cells => cells.map(cell => Number(cell.dataset.value))")
    return values == [value for row in pose["matrix"] for value in row]


@pytest.mark.parametrize("webgl", [True, False])
def test_a_drag_stays_under_ten_requests_a_second(webgl, visit, counting):
    found = visit(f"robot=puma560&q=0,45,-90,0,45,0&{ALL_OPEN}", webgl=webgl)
    page = found.page
    page.wait_for_selector("img.picture" if not webgl else ".host canvas")
    begun = page.evaluate(SLIDE, 6000)
    found.settled()
    assert most_in_a_second(page, begun) < 10
    assert len([one for one in page.evaluate("() => window.sentAt") if one > begun]) > 20
    assert 429 not in found.statuses
    until(lambda: shows_the_pose_of(page, counting, "puma560", [37, 45, -90, 0, 45, 0]))


def test_so_does_the_drag_of_the_target(visit):
    found = visit(f"robot=puma560&q=0,45,-90,0,45,0&{ALL_OPEN}")
    page = found.page
    page.wait_for_function(HANDLE)
    begun = page.evaluate("() => performance.now()")
    at = page.evaluate(HANDLE)
    page.mouse.move(at["x"], at["y"])
    page.mouse.down()
    for k in range(120):
        page.mouse.move(at["x"] - k % 40, at["y"] + k % 30)
        page.wait_for_timeout(30)
    page.mouse.up()
    found.settled()
    assert most_in_a_second(page, begun) < 10
    assert 429 not in found.statuses
    assert "Reached" in page.locator("#section-ik .verdict").inner_text()


def test_a_robot_with_many_meshes_is_loaded_at_the_pace_of_the_service(visit):
    found = visit("robot=panda_urdf&q=0,0,0,-90,0,90,0")
    found.page.wait_for_function("() => document.querySelector('.host').probe?.meshes() > 5")
    found.settled()
    assert 429 not in found.statuses


def test_who_is_refused_for_the_requests_of_others_waits_and_says_nothing(open_page, tmp_path):
    with served(tmp_path, program=DENAVIT, rate_limit="20/second") as server:
        found = open_page("robot=planar_2r&q=0,0", address=server.address, refusals=True)
        page, statuses = found.page, []
        page.on("response", lambda answer: statuses.append(answer.status))
        stop = threading.Event()

        def others() -> None:
            with httpx.Client(base_url=server.address, timeout=PATIENCE) as client:
                while not stop.is_set():
                    client.get("/v1/nothing")

        threads = [threading.Thread(target=others) for _ in range(3)]
        for one in threads:
            one.start()
        value = page.locator(".joint .value").nth(0)
        try:
            for k in range(600):
                value.fill(str(k % 50))
                page.wait_for_timeout(100)
                assert page.locator(".toast").is_hidden()
                if 429 in statuses:
                    break
        finally:
            stop.set()
            for one in threads:
                one.join()
        assert 429 in statuses
        value.fill("60")
        until(
            lambda: (
                page.wait_for_timeout(500) or shows_the_pose_of(page, server, "planar_2r", [60, 0])
            )
        )
        assert page.locator(".toast").is_hidden()
        assert not page.locator(".stale").count()
