"""The 3D scene: frames where the service has them, the tool dragged, joints turned by hand."""

import itertools

import numpy as np
import pytest

ROBOTS = {
    "planar_3r": [30.0, -45.0, 60.0],
    "scara": [20.0, 40.0, 0.08, -30.0],
    "puma560": [10.0, 20.0, -100.0, 30.0, 25.0, 40.0],
    "ur5": [15.0, -60.0, 80.0, -110.0, -90.0, 12.5],
    "pa10": [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0],
    "panda_urdf": [0.0, -30.0, 10.0, -120.0, 5.0, 100.0, 45.0],
}
POSES = "() => document.querySelector('.host').probe.poses()"
HANDLE = "() => document.querySelector('.host').probe.handle()"


def shown(visit):
    visit.page.wait_for_function("() => document.querySelector('.host')?.probe")
    return {name: np.array(T) for name, T in visit.page.evaluate(POSES).items()}


def padded(client, robot, q):
    """The posture with zeros for the joints that it leaves out, such as fingers."""
    dof = client.get(f"/v1/robots/{robot}").json()["dof"]
    return [*q, *[0.0] * (dof - len(q))]


def dragged(visit, dx, dy, steps=8):
    visit.page.wait_for_function("() => document.querySelector('.host')?.probe?.handle()")
    at = visit.page.evaluate(HANDLE)
    mouse = visit.page.mouse
    mouse.move(at["x"], at["y"])
    mouse.down()
    for k in range(1, steps + 1):
        mouse.move(at["x"] + dx * k / steps, at["y"] + dy * k / steps)
    mouse.up()
    return at


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_frame_is_where_the_service_has_it(robot, open_page, client):
    q = padded(client, robot, ROBOTS[robot])
    visit = open_page(f"robot={robot}&q={','.join(map(str, q))}&open=pose")
    poses = client.post(f"/v1/robots/{robot}/fk?angle=deg", json={"q": q, "frames": "all"})
    found = shown(visit)
    for name, pose in poses.json()["poses"].items():
        assert np.abs(found[name] - pose["matrix"]).max() < 1e-6, name


@pytest.mark.parametrize("robot", ["puma560", "planar_3r", "pa10"])
def test_a_drag_takes_the_tool_along(robot, open_page, client):
    """Where the ball is let go, the tool is, and q on the page yields it."""
    q = ROBOTS[robot]
    task = "&task=xy" if robot == "planar_3r" else ""
    visit = open_page(f"robot={robot}&q={','.join(map(str, q))}&open=pose{task}")
    before = shown(visit)["tool"]
    dragged(visit, -24, 18)
    visit.page.wait_for_function(
        "T => Math.abs(document.querySelector('.host').probe.poses().tool[0][3] - T) > 1e-3",
        arg=before[0, 3],
    )
    visit.settled()
    visit.page.wait_for_timeout(500)
    target = np.array(visit.page.evaluate("() => document.querySelector('.host').probe.target()"))
    tool = shown(visit)["tool"]
    assert np.linalg.norm(tool[:3, 3] - target[:3, 3]) < 1e-5
    assert np.linalg.norm(tool[:3, 3] - before[:3, 3]) > 0.01
    values = [float(one.input_value()) for one in visit.page.locator(".joint .value").all()]
    pose = client.post(f"/v1/robots/{robot}/fk?angle=deg", json={"q": values}).json()["poses"]
    # The fields hold as many digits as q has.
    assert np.abs(np.array(pose["tool"]["matrix"]) - tool).max() < 1e-9
    if robot == "planar_3r":
        assert abs(tool[2, 3]) < 1e-12


def test_a_joint_is_turned_by_hand_and_no_other(open_page, client):
    visit = open_page("robot=planar_2r&q=30,60&open=pose")
    places = shown(visit)
    # A point of the second link, away from the ball at its end, in client pixels.
    ends = (
        visit.page.evaluate(HANDLE),
        visit.page.evaluate("() => document.querySelector('.host').probe.pixel('frame_1')"),
    )
    x, y = (0.5 * (ends[0][k] + ends[1][k]) for k in "xy")
    mouse = visit.page.mouse
    mouse.move(x, y)
    mouse.down()
    for k in range(1, 6):
        mouse.move(x - 8 * k, y)
    mouse.up()
    visit.settled()
    values = [float(one.input_value()) for one in visit.page.locator(".joint .value").all()]
    assert values[0] == 30.0
    assert abs(values[1] - 60.0) > 2.0
    assert np.abs(shown(visit)["frame_1"] - places["frame_1"]).max() < 1e-12


def test_rows_are_shown_in_their_four_motions(open_page):
    visit = open_page("robot=puma560&q=10,20,-100,30,25,40&row=2,4")
    pixels = []
    for step in range(5):
        visit.go(f"robot=puma560&q=10,20,-100,30,25,40&row=2,{step}")
        visit.page.wait_for_timeout(400)
        pixels.append(visit.page.locator(".host canvas").screenshot())
    for one, other in itertools.pairwise(pixels):
        assert one != other


def test_nothing_moves_the_arm_but_its_own_joints(open_page):
    """Turning the camera leaves every frame where it is."""
    visit = open_page("robot=puma560&q=10,20,-100,30,25,40")
    before = shown(visit)
    box = visit.page.locator(".host canvas").bounding_box()
    mouse = visit.page.mouse
    mouse.move(box["x"] + 30, box["y"] + box["height"] - 30)
    mouse.down()
    mouse.move(box["x"] + 130, box["y"] + box["height"] - 80, steps=4)
    mouse.up()
    after = shown(visit)
    assert all(np.array_equal(before[name], after[name]) for name in before)


def test_meshes_of_a_shipped_arm_come_from_the_service(open_page, client):
    asked = []
    visit = open_page(None)
    visit.page.on(
        "response", lambda r: asked.append((r.url, r.status)) if "/meshes/" in r.url else None
    )
    visit.go("robot=panda_urdf&q=0,-30,10,-120,5,100,45,0,0")
    files = {line["href"] for line in client.get("/v1/robots/panda_urdf/meshes").json()["meshes"]}
    visit.page.wait_for_function(
        "() => document.querySelector('.host').probe.meshes() > 8", timeout=60_000
    )
    assert {url.split("/", 3)[3] for url, status in asked if status == 200} >= files
