"""What stands on the page is what the service says, and follows what is moved."""

import json
import subprocess

import httpx
import numpy as np
import pytest

from tests.conftest import PATIENCE
from tests.scenes import one_scene

POSTURES = {
    "planar_2r": [30.0, 45.0],
    "scara": [20.0, 40.0, 0.08, -30.0],
    "puma560": [10.0, 20.0, -100.0, 30.0, 25.0, 40.0],
    "ur5": [15.0, -60.0, 80.0, -110.0, -90.0, 12.5],
    "pa10": [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0],
    "panda_urdf": [0.0, -30.0, 10.0, -120.0, 5.0, 100.0, 45.0, 0.01],
}


def posture(q: list[float]) -> str:
    return ",".join(str(x) for x in q)


@pytest.mark.parametrize("robot", one_scene(POSTURES))
def test_pose_and_jacobian_are_those_of_the_service(robot, open_page, client):
    q = POSTURES[robot]
    visit = open_page(f"robot={robot}&q={posture(q)}&open=pose,jacobian")
    body = {"q": q}
    (pose,) = client.post(f"/v1/robots/{robot}/fk?angle=deg", json=body).json()["poses"].values()
    J = client.post(f"/v1/robots/{robot}/jacobian?angle=deg", json=body).json()["jacobian"]
    np.testing.assert_array_equal(visit.matrix("pose"), pose["matrix"])
    np.testing.assert_array_equal(visit.matrix("jacobian"), J)


def test_cells_show_what_they_hold(open_page):
    visit = open_page("robot=puma560&q=10,20,-100,30,25,40&open=pose&digits=6")
    cells = visit.page.locator("#section-pose .matrix td").all()
    assert len(cells) == 16
    for cell in cells:
        shown = float(cell.inner_text().replace("−", "-"))
        assert shown == pytest.approx(float(cell.get_attribute("data-value")), abs=5.1e-7)


def test_a_slider_moves_its_joint_and_no_other(open_page, client):
    before = POSTURES["puma560"]
    visit = open_page(f"robot=puma560&q={posture(before)}&open=pose")
    for k in range(6):
        slider = visit.page.locator(".joint input[type=range]").nth(k)
        value = float(slider.evaluate("one => one.value"))
        slider.focus()
        visit.page.keyboard.press("ArrowRight")
        visit.settled()
        shown = [float(field.input_value()) for field in visit.page.locator(".joint .value").all()]
        moved = [i for i in range(6) if shown[i] != before[i]]
        assert moved == [k], (k, shown)
        assert shown[k] > value
        before = shown
    body = {"q": before}
    (pose,) = client.post("/v1/robots/puma560/fk?angle=deg", json=body).json()["poses"].values()
    visit.page.wait_for_function(
        "x => Number(document.querySelector('#section-pose .matrix td[data-value]')"
        ".dataset.value) === x",
        arg=pose["matrix"][0][0],
    )
    np.testing.assert_array_equal(visit.matrix("pose"), pose["matrix"])


def test_numbers_follow_a_typed_value_in_degrees_and_in_radians(open_page, client):
    visit = open_page("robot=planar_2r&q=0,0&task=xy&open=pose,singularity")
    visit.page.locator(".joint .value").nth(0).fill("90")
    visit.page.wait_for_function(
        "() => Math.abs(document.querySelector('#section-pose .matrix tr:nth-child(2) "
        "td:nth-child(4)').dataset.value - 1.8) < 1e-12"
    )
    visit.page.get_by_label("Unit of angles").select_option("rad")
    visit.settled()
    field = visit.page.locator(".joint .value").nth(0)
    assert float(field.input_value()) == pytest.approx(np.pi / 2, abs=1e-11)
    assert (
        "Singular: rank 1 instead of 2" in visit.page.locator("#section-singularity").inner_text()
    )


@pytest.mark.parametrize("source", ["stored", "typed"])
def test_the_copied_curl_gives_the_same_pose(source, open_page, server):
    visit = open_page(f"robot=pa10&q={posture(POSTURES['pa10'])}&open=pose,reproduce")
    if source == "typed":
        visit.page.get_by_label("row 3, r", exact=False).fill("0.5")
        visit.page.wait_for_function(
            "() => document.querySelector('.code')?.textContent.includes('0.5')"
        )
        visit.settled()
    visit.page.wait_for_selector(".code:has-text('curl')")
    command = visit.page.locator(".code").inner_text()
    assert command.startswith("curl ")
    done = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, timeout=PATIENCE, check=True
    )
    (pose,) = json.loads(done.stdout)["poses"].values()
    np.testing.assert_array_equal(visit.matrix("pose"), pose["matrix"])


def test_the_copied_program_gives_the_same_jacobian(open_page, tmp_path):
    visit = open_page(f"robot=ur5&q={posture(POSTURES['ur5'])}&open=pose,jacobian")
    visit.page.get_by_label("Show the request: Jacobian").click()
    visit.page.get_by_role("button", name="Python").click()
    visit.page.wait_for_selector(".code:has-text('httpx')")
    program = tmp_path / "program.py"
    program.write_text(visit.page.locator(".code").inner_text())
    printed: list[dict] = []
    exec(compile(program.read_text(), str(program), "exec"), {"print": printed.append})
    np.testing.assert_array_equal(visit.matrix("jacobian"), printed[0]["jacobian"])


def test_all_solutions_are_shown_and_can_be_picked(open_page, client):
    visit = open_page("robot=ur5&q=0,-60,90,-120,-90,0&open=pose,ik")
    visit.page.get_by_role("button", name="Target here").click()
    visit.page.get_by_role("button", name="All solutions").click()
    visit.page.wait_for_selector(".solutions button")
    found = visit.page.locator(".solutions button")
    assert found.count() == 8
    wanted = visit.matrix("pose")
    for k in (1, 5):
        found.nth(k).click()
        visit.settled()
        q = [float(x) for x in found.nth(k).get_attribute("data-q").split(",")]
        (pose,) = client.post("/v1/robots/ur5/fk?angle=deg", json={"q": q}).json()["poses"].values()
        visit.shows("pose", pose["matrix"])
        np.testing.assert_allclose(visit.matrix("pose"), wanted, atol=1e-9)


@pytest.mark.scene
def test_a_typed_target_is_reached(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose,ik")
    visit.page.get_by_role("button", name="Target here").click()
    visit.page.get_by_label("Target, x").fill("0.5")
    visit.page.wait_for_selector("text=Reached.")
    visit.page.wait_for_function(
        "() => Math.abs(document.querySelector('#section-pose .matrix tr td:nth-child(4)')"
        ".dataset.value - 0.5) < 1e-5"
    )
    visit.page.get_by_label("Target, x").fill("5")
    visit.page.wait_for_selector("text=Out of reach")


def test_methods_are_compared_and_played(open_page):
    visit = open_page("robot=planar_8r&q=109,-14,-26,-29,-29,-20,0,11&open=pose,path")
    page = visit.page
    page.locator("#section-path").get_by_label("Task", exact=True).select_option("xy")
    page.get_by_label("x", exact=True).fill("1.15")
    page.get_by_label("y", exact=True).fill("-0.15")
    page.get_by_role("button", name="Compare the methods").click()
    page.wait_for_selector("text=pseudo_inverse")
    row = page.locator("#section-path .factors tbody tr", has_text="qp")
    assert "yes" in row.inner_text()
    row.get_by_role("button").click()
    page.wait_for_function(
        "() => Math.abs(document.querySelector('#section-pose .matrix tr td:nth-child(4)')"
        ".dataset.value - 1.15) < 1e-4"
    )


def test_the_link_opens_the_same_page(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose")
    page = visit.page
    page.get_by_label("Row 2, a", exact=True).fill("0.5")
    page.locator(".joint .value").nth(0).fill("33")
    page.wait_for_function(
        "() => location.hash.includes('q=33') && location.hash.includes('table=')"
    )
    visit.settled()
    wanted = visit.matrix("pose")
    other = open_page(page.url.partition("#")[2])
    np.testing.assert_array_equal(other.matrix("pose"), wanted)
    assert other.page.get_by_label("Row 2, a", exact=True).input_value() == "0.5"


def test_nothing_is_stored_until_it_is_saved(open_page, client):
    before = client.get("/v1/robots?page_size=1000").json()["robots"]
    visit = open_page("robot=planar_2r&q=10,20&open=pose", refusals=True)
    page = visit.page
    page.get_by_label("Row 1, a", exact=True).fill("1.25")
    visit.settled()
    assert client.get("/v1/robots?page_size=1000").json()["robots"] == before
    page.get_by_role("button", name="Save …").click()
    page.get_by_label("Name").fill("from-the-page")
    page.get_by_role("dialog").get_by_role("button", name="Save …").click()
    page.wait_for_function("() => location.hash.includes('robot=from-the-page')")
    saved = client.get("/v1/robots/from-the-page/dh").json()
    assert saved["joints"][0]["a"] == 1.25
    page.get_by_label("Row 1, a", exact=True).fill("1.5")
    visit.settled()
    page.get_by_role("button", name="Save …").click()
    page.get_by_label("Name").fill("from-the-page")
    page.get_by_role("dialog").get_by_role("button", name="Save …").click()
    page.get_by_role("dialog").get_by_text("stored already").wait_for()
    assert client.get("/v1/robots/from-the-page/dh").json() == saved
    page.get_by_role("button", name="Replace it").click()
    page.wait_for_function("() => location.hash.includes('robot=from-the-page')")
    assert client.get("/v1/robots/from-the-page/dh").json()["joints"][0]["a"] == 1.5
    assert client.delete("/v1/robots/from-the-page").status_code == 204


def test_the_page_works_behind_a_path_prefix(open_page, server):
    import http.server
    import threading

    class Proxy(http.server.BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def forward(self) -> None:
            assert self.path.startswith("/teaching/")
            size = int(self.headers.get("content-length") or 0)
            answer = httpx.request(
                self.command,
                server + self.path.removeprefix("/teaching"),
                content=self.rfile.read(size),
                headers={
                    k: v for k, v in self.headers.items() if k.lower() in ("accept", "content-type")
                },
                timeout=PATIENCE,
            )
            self.send_response(answer.status_code)
            for name in ("content-type", "content-security-policy"):
                if name in answer.headers:
                    self.send_header(name, answer.headers[name])
            self.send_header("content-length", str(len(answer.content)))
            self.end_headers()
            self.wfile.write(answer.content)

        do_GET = do_POST = forward  # noqa: N815

        def log_message(self, *_: object) -> None:
            pass

    proxy = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Proxy)
    threading.Thread(target=proxy.serve_forever, daemon=True).start()
    try:
        address = f"http://127.0.0.1:{proxy.server_port}/teaching/"
        refused: list[str] = []
        visit = open_page(None, address=address.rstrip("/"))
        page = visit.page
        page.on(
            "response", lambda answer: refused.append(answer.url) if answer.status >= 400 else None
        )
        page.goto(
            address + "#robot=panda_urdf&q=0,-30,0,-120,0,100,45,0"
            "&open=pose,jacobian,ik,path,reproduce"
        )
        page.wait_for_selector("#section-jacobian .matrix td[data-value]")
        page.wait_for_function("() => document.querySelector('.host')?.probe?.meshes() > 8")
        visit.settled()
        command = page.locator(".code").inner_text()
        assert f"'{address}v1/robots/panda_urdf/fk?" in command
        done = subprocess.run(
            ["bash", "-c", command], capture_output=True, text=True, timeout=PATIENCE, check=True
        )
        (pose,) = json.loads(done.stdout)["poses"].values()
        np.testing.assert_array_equal(visit.matrix("pose"), pose["matrix"])
        assert not refused
    finally:
        proxy.shutdown()
        proxy.server_close()


def test_back_and_forward_go_from_robot_to_robot(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose")
    page = visit.page
    page.locator(".joint .value").nth(0).fill("33")
    page.wait_for_function("() => location.hash.includes('q=33')")
    page.get_by_role("button", name="UR5").click()
    page.wait_for_function("() => location.hash.includes('robot=ur5')")
    page.locator(".joint .value").nth(0).fill("12")
    page.wait_for_function("() => location.hash.includes('q=12')")
    page.go_back()
    page.wait_for_function("() => document.title.includes('PUMA')")
    visit.settled()
    assert page.locator(".joint .value").nth(0).input_value() == "33"
    page.go_forward()
    page.wait_for_function("() => document.title.includes('UR5')")
    visit.settled()
    assert page.locator(".joint .value").nth(0).input_value() == "12"


def test_a_robot_too_long_for_a_link_outlives_a_reload_and_the_link_says_so(open_page, tmp_path):
    noise = np.random.default_rng(0).bytes(15_000).hex()
    file = tmp_path / "long.urdf"
    file.write_text(
        f'<robot name="long"><!-- {noise} --><link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="j1" type="continuous"><parent link="a"/><child link="b"/></joint>'
        '<joint name="j2" type="continuous"><parent link="b"/><child link="c"/>'
        '<origin xyz="0.3 0.1 0.2"/></joint></robot>'
    )
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose")
    page = visit.page
    page.locator("input[type=file]").set_input_files(str(file))
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 2")
    page.locator(".joint .value").nth(0).fill("25")
    page.wait_for_function("() => /left-out.*q=25,0/.test(location.hash)")
    visit.settled()
    wanted = visit.matrix("pose")
    page.get_by_role("button", name="Copy link").click()
    page.get_by_text("too long for a link").wait_for()
    page.reload()
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 2")
    visit.settled()
    np.testing.assert_array_equal(visit.matrix("pose"), wanted)
    elsewhere = open_page(page.url.partition("#")[2])
    elsewhere.page.get_by_text("too long for a link").wait_for()


def answer_503(route) -> None:
    problem = {"title": "busy", "status": 503, "detail": "the service is busy; try again in 1 s"}
    route.fulfill(status=503, content_type="application/problem+json", body=json.dumps(problem))


@pytest.mark.parametrize("how", ["busy", "gone"])
def test_numbers_come_by_themselves_once_the_service_is_back(how, open_page, client):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose", outages=True)
    page = visit.page
    page.route("**/v1/**", answer_503 if how == "busy" else lambda route: route.abort())
    page.locator(".joint .value").nth(0).fill("33")
    words = "the service is busy" if how == "busy" else "The service does not answer"
    page.locator(".toast", has_text=words).wait_for()
    page.get_by_role("button", name="Workspace").click()
    page.wait_for_timeout(400)
    page.unroute("**/v1/**")
    page.locator(".toast").wait_for(state="hidden")
    visit.settled()
    body = {"q": [33, 45, -90, 0, 45, 0]}
    (pose,) = client.post("/v1/robots/puma560/fk?angle=deg", json=body).json()["poses"].values()
    np.testing.assert_array_equal(visit.matrix("pose"), pose["matrix"])
    assert page.locator(".stale").count() == 0


def test_a_robot_chosen_while_the_service_is_away_comes_later(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose", outages=True)
    page = visit.page
    page.route("**/v1/**", lambda route: route.abort())
    page.get_by_role("button", name="UR5").click()
    page.locator("body.stale").wait_for()
    page.unroute("**/v1/**")
    page.wait_for_function("() => document.title.includes('UR5')")
    visit.settled()
    assert page.locator("body.stale").count() == 0


def test_a_typed_target_waits_until_the_number_is_there(open_page):
    """On the way to 0.55 there is 0: the arm shall not jump there."""
    asked: list[float] = []
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose,ik")
    page = visit.page

    def told(request) -> None:
        if request.url.split("?")[0].endswith("/ik"):
            asked.append(json.loads(request.post_data)["target"]["position"][0])

    page.on("request", told)
    page.get_by_role("button", name="Target here").click()
    field = page.get_by_label("Target, x")
    field.fill("")
    field.press_sequentially("0.55", delay=40)
    page.wait_for_selector("text=Reached.")
    assert asked == [0.55]


def test_a_slow_service_ends_with_the_last_that_was_asked_for(open_page, client):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose,jacobian")
    page = visit.page
    page.evaluate("""() => {
        const quick = window.fetch;
        let count = 0;
        window.delayed = 0;
        // Each answer takes another time: they come in another order than they were asked for.
        window.fetch = async (...given) => {
            window.delayed += 1;
            await new Promise(done => setTimeout(done, [400, 50, 250, 10][count++ % 4]));
            try {
                return await quick(...given);
            } finally {
                window.delayed -= 1;
            }
        };
    }""")
    for name in ("UR5", "PA10", "SCARA", "PUMA 560"):
        page.get_by_role("button", name=name).click()
        page.wait_for_timeout(60)
    for value in ("10", "20", "30", "40"):
        page.locator(".joint .value").nth(0).fill(value)
        page.wait_for_timeout(60)
    page.wait_for_timeout(2500)
    page.wait_for_function("() => window.delayed === 0 && window.isQuiet()")
    visit.settled()
    body = {"q": [40, 45, -90, 0, 45, 0]}
    (pose,) = client.post("/v1/robots/puma560/fk?angle=deg", json=body).json()["poses"].values()
    np.testing.assert_array_equal(visit.matrix("pose"), pose["matrix"])
    J = client.post("/v1/robots/puma560/jacobian?angle=deg", json=body).json()["jacobian"]
    np.testing.assert_array_equal(visit.matrix("jacobian"), J)
