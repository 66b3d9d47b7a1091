"""The 3D scene: frames where the service has them, the tool dragged, joints turned by hand."""

import itertools

import numpy as np
import pytest

from tests.conftest import until
from tests.scenes import one_scene

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


def still(visit) -> bytes:
    """A picture of the scene, once it changes no more."""
    seen = [b""]

    def repeats() -> bool:
        visit.page.wait_for_timeout(200)
        seen.append(visit.page.locator(".host canvas").screenshot())
        return seen[-1] == seen[-2]

    until(repeats)
    return seen[-1]


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


@pytest.mark.parametrize("robot", one_scene(ROBOTS))
def test_every_frame_is_where_the_service_has_it(robot, open_page, client):
    q = padded(client, robot, ROBOTS[robot])
    visit = open_page(f"robot={robot}&q={','.join(map(str, q))}&open=pose")
    poses = client.post(f"/v1/robots/{robot}/fk?angle=deg", json={"q": q, "frames": "all"})
    found = shown(visit)
    for name, pose in poses.json()["poses"].items():
        assert np.abs(found[name] - pose["matrix"]).max() < 1e-6, name


@pytest.mark.parametrize("robot", one_scene(["puma560", "planar_3r", "pa10"]))
def test_a_drag_takes_the_tool_along(robot, open_page, client):
    """Where the ball is let go, the tool is, and q on the page yields it."""
    q = ROBOTS[robot]
    task = "&task=xy" if robot == "planar_3r" else ""
    visit = open_page(f"robot={robot}&q={','.join(map(str, q))}&open=pose{task}")
    before = shown(visit)["tool"]
    at = dragged(visit, -24, 18)
    visit.page.wait_for_function(
        "T => Math.abs(document.querySelector('.host').probe.poses().tool[0][3] - T) > 1e-3",
        arg=before[0, 3],
    )
    visit.settled()
    target = np.array(visit.page.evaluate("() => document.querySelector('.host').probe.target()"))
    tool = shown(visit)["tool"]
    assert np.linalg.norm(tool[:3, 3] - target[:3, 3]) < 1e-5
    assert np.linalg.norm(tool[:3, 3] - before[:3, 3]) > 0.01
    # The ball is under the pointer, where it was let go.
    ball = visit.page.evaluate(HANDLE)
    assert (ball["x"] - at["x"], ball["y"] - at["y"]) == pytest.approx((-24, 18), abs=0.5)
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
        visit.page.wait_for_function("() => document.querySelector('.host')?.probe?.motion()")
        pixels.append(still(visit))
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
    visit.go("robot=panda_urdf&q=0,-30,10,-120,5,100,45,0")
    files = {line["href"] for line in client.get("/v1/robots/panda_urdf/meshes").json()["meshes"]}
    visit.page.wait_for_function("() => document.querySelector('.host').probe.meshes() > 8")
    assert {url.split("/", 3)[3] for url, status in asked if status == 200} >= files


TURNS = {"x": 0, "z": 2}


def elementary(kind: str, axis: str, value: float) -> np.ndarray:
    T = np.eye(4)
    k = TURNS[axis]
    if kind == "T":
        T[k, 3] = value
        return T
    i, j = (k + 1) % 3, (k + 2) % 3
    c, s = np.cos(value), np.sin(value)
    T[i, i], T[i, j], T[j, i], T[j, j] = c, -s, s, c
    return T


MOTIONS = {
    "puma560": ("standard", 2, ("Rz theta", "Tz d", "Tx a", "Rx alpha")),
    "panda": ("modified", 4, ("Tx a", "Rx alpha", "Rz theta", "Tz d")),
    "rx90": ("khalil", 4, ("Tx d", "Rx alpha", "Rz theta", "Tz r")),
}


@pytest.mark.parametrize("robot", MOTIONS)
def test_each_motion_takes_the_frame_where_the_row_says(robot, open_page, client):
    convention, row, motions = MOTIONS[robot]
    dof = client.get(f"/v1/robots/{robot}").json()["dof"]
    q = [10.0, 20.0, -50.0, -70.0, 25.0, 40.0, 15.0][:dof]
    table = client.get(f"/v1/robots/{robot}/dh?convention={convention}&angle=rad").json()
    cells = table["joints"][row - 1]
    value = {name: float(cells.get(name, 0)) for name in ("a", "d", "r", "alpha", "theta")}
    value["theta"] += cells.get("sign", 1) * np.deg2rad(q[row - 1]) + cells.get("offset", 0)
    frames = client.post(f"/v1/robots/{robot}/fk?angle=deg", json={"q": q, "frames": "all"})
    poses = {name: np.array(one["matrix"]) for name, one in frames.json()["poses"].items()}
    expected = poses[f"frame_{row - 1}"]
    page = open_page(f"robot={robot}&q={','.join(map(str, q))}&row={row},0").page
    page.wait_for_function("() => document.querySelector('.host')?.probe?.motion()")
    for step, motion in enumerate(["", *motions]):
        if motion:
            name, column = motion.split()
            expected = expected @ elementary(name[0], name[1], value[column])
            page.get_by_role("group", name="Link matrix").get_by_role("button").nth(
                step - 1
            ).click()
        moving = np.array(page.evaluate("() => document.querySelector('.host').probe.motion()"))
        assert np.abs(moving - expected).max() < 1e-9, (motion, moving)
    assert np.abs(moving - poses[f"frame_{row}"]).max() < 1e-9


def texts(page) -> set[str]:
    found = page.evaluate("() => document.querySelector('.host').probe.labels().map(l => l.text)")
    return set(found)


@pytest.mark.parametrize(
    ("robot", "q", "names"),
    [
        (
            "puma560",
            "0,45,-90,0,45,0",
            {"d₁ = 0.6718 m", "a₂ = 0.4318 m", "d₃ = 0.15 m", "a₃ = 0.0203 m", "d₄ = 0.4318 m"},
        ),
        (
            "panda",
            "0,-30,0,-120,0,100,45",
            {
                "d₁ = 0.333 m",
                "d₃ = 0.316 m",
                "a₃ = 0.0825 m",
                "a₄ = -0.0825 m",
                "d₅ = 0.384 m",
                "a₆ = 0.088 m",
            },
        ),
        ("rx90", "10,20,-50,30,25,40", {"d₃ = 0.45 m", "r₄ = 0.45 m"}),
        ("scara", "20,40,0.08,0", {"d₁ = 0.387 m", "a₁ = 0.325 m", "a₂ = 0.275 m", "d₃ = 0.08 m"}),
    ],
)
def test_lengths_are_named_as_the_convention_names_them(robot, q, names, open_page):
    page = open_page(f"robot={robot}&q={q}&view=frames:none,dimensions").page
    page.wait_for_function("() => document.querySelector('.host')?.probe?.labels().length > 1")
    assert {text for text in texts(page) if "=" in text} == names


SIZES = {"wide": (1440, 900), "narrow": (390, 844)}


def settled_labels(page) -> list[dict]:
    """The labels, once they stay where they are."""
    seen = [[]]

    def repeats() -> bool:
        page.wait_for_timeout(100)
        seen.append(page.evaluate("() => document.querySelector('.host').probe.labels()"))
        return seen[-1] == seen[-2]

    until(repeats)
    return seen[-1]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize(
    ("robot", "q"),
    [
        ("puma560", "0,45,-90,0,45,0"),
        ("pa10", "0,0,0,0,0,0,0"),
        ("planar_8r", "109,-14,-26,-29,-29,-20,0,11"),
        ("stanford", "20,-60,0.6,0,40,0"),
    ],
)
def test_no_label_hides_another_and_the_arm_fills_the_view(robot, q, size, open_page):
    width, height = SIZES[size]
    page = open_page(
        f"robot={robot}&q={q}&view=frames:all,dimensions",
        viewport={"width": width, "height": height},
    ).page
    page.wait_for_function("() => document.querySelector('.host')?.probe?.labels().length > 3")
    labels = settled_labels(page)
    for one, other in itertools.combinations(labels, 2):
        apart = (
            abs(one["x"] - other["x"]) - one["halfWidth"] - other["halfWidth"],
            abs(one["y"] - other["y"]) - one["halfHeight"] - other["halfHeight"],
        )
        assert max(apart) > -1e-6, (one, other)
    box = page.locator(".host").bounding_box()
    for one in labels:
        assert one["halfWidth"] - 1e-6 <= one["x"] <= box["width"] - one["halfWidth"] + 1e-6
        assert one["halfHeight"] - 1e-6 <= one["y"] <= box["height"] - one["halfHeight"] + 1e-6
    frames = [name for name in page.evaluate(POSES) if name.startswith(("frame", "tool"))]
    assert {f"x{n}" for n in "₀₁"} <= texts(page)
    pixels = np.array(
        [
            [at["x"] - box["x"], at["y"] - box["y"]]
            for at in (
                page.evaluate("f => document.querySelector('.host').probe.pixel(f)", name)
                for name in frames
            )
        ]
    )
    assert (pixels > 0).all()
    assert (pixels < (box["width"], box["height"])).all()
    assert max(np.ptp(pixels, axis=0) / (box["width"], box["height"])) > 0.45


def layers(page) -> dict[str, int]:
    page.wait_for_function("() => document.querySelector('.host')?.probe?.poses()")
    page.wait_for_function("() => window.isQuiet()")
    return page.evaluate("() => document.querySelector('.host').probe.shown()")


@pytest.mark.parametrize(
    ("task", "shown", "count"),
    [
        ("pose", "velocity", 1),
        ("position", "force", 1),
        ("pose", "both", 2),
        ("orientation", "velocity", 1),
        ("orientation", "both", 2),
        ("xy", "both", 2),
        ("pose", "none", 0),
    ],
)
def test_ellipsoids_of_the_chosen_task(task, shown, count, open_page):
    visit = open_page(f"robot=puma560&q=10,20,-100,30,25,40&task={task}&view=ellipsoid:{shown}")
    assert layers(visit.page)["ellipsoids"] == count


def test_an_arrow_shows_what_a_singularity_loses_and_nothing_else(open_page, client):
    """A stretched arm in the plane cannot move along itself; three joints are not a singularity."""
    visit = open_page("robot=planar_2r&q=30,0&task=xy")
    assert layers(visit.page)["lost"] > 0
    arrows = np.array(visit.page.evaluate("() => document.querySelector('.host').probe.lost()"))
    along = np.array([np.cos(np.pi / 6), 0.5, 0.0])
    assert len(arrows) == 2
    assert np.abs(np.abs(arrows @ along) - 1).max() < 1e-6
    visit.page.locator(".joint .value").nth(1).fill("60")
    visit.settled()
    assert layers(visit.page)["lost"] == 0
    visit.go("robot=planar_3r&q=30,-45,60&task=pose")
    answer = client.get("/v1/robots/planar_3r/singularity?q=30,-45,60&angle=deg&task=pose").json()
    assert answer["lost_directions"]
    assert not answer["singular"]
    assert layers(visit.page)["lost"] == 0


def test_solutions_are_ghosts_that_can_be_picked_in_the_view(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose,ik")
    page = visit.page
    page.get_by_role("button", name="Target here").click()
    page.get_by_role("button", name="All solutions").click()
    page.wait_for_selector(".solutions button")
    assert layers(page)["ghosts"] > 0
    # The middle of the upper arm of each ghost; one that stands in front of another is picked.
    count = page.locator(".solutions button").count()
    picked = None
    for k in range(count):
        a, b = (
            page.evaluate(
                "([k, f]) => document.querySelector('.host').probe.ghost(k, f)", [k, frame]
            )
            for frame in ("frame_1", "frame_2")
        )
        page.mouse.click(0.5 * (a["x"] + b["x"]), 0.5 * (a["y"] + b["y"]))
        visit.settled()
        visit.drawn()
        pressed = page.locator(".solutions button[aria-pressed=true]")
        if pressed.count() and pressed.first.locator("b").inner_text() != "1":
            picked = pressed.first
            break
    assert picked is not None
    q = [float(x) for x in picked.get_attribute("data-q").split(",")]
    assert q[1] == pytest.approx(float(page.locator(".joint .value").nth(1).input_value()))
    # They are solutions of that target: another one takes them away.
    dragged(visit, -20, 10)
    page.wait_for_function("() => document.querySelector('.host').probe.shown().ghosts === 0")
    assert page.locator(".solutions button").count() == 0


def test_a_finger_drags_the_tool(open_page):
    visit = open_page(
        "robot=puma560&q=0,45,-90,0,45,0&open=pose",
        viewport={"width": 390, "height": 844},
        has_touch=True,
        is_mobile=True,
    )
    page = visit.page
    before = shown(visit)["tool"]
    page.wait_for_function("() => document.querySelector('.host').probe.handle()")
    at = page.evaluate(HANDLE)
    session = page.context.new_cdp_session(page)

    def touch(kind: str, *points: tuple[float, float]) -> None:
        touches = [{"x": x, "y": y} for x, y in points]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches})

    # A finger does not hit the ball in its middle.
    x, y = at["x"] + 14, at["y"] + 12
    touch("touchStart", (x, y))
    for k in range(1, 7):
        touch("touchMove", (x - 6 * k, y + 4 * k))
        page.wait_for_timeout(30)
    touch("touchEnd")
    page.wait_for_function(
        "T => Math.abs(document.querySelector('.host').probe.poses().tool[0][3] - T) > 0.01",
        arg=before[0, 3],
    )
    visit.settled()
    target = np.array(page.evaluate("() => document.querySelector('.host').probe.target()"))
    assert np.linalg.norm(shown(visit)["tool"][:3, 3] - target[:3, 3]) < 1e-5
    assert page.evaluate("() => scrollY") == 0


def test_a_second_robot_is_fetched_once(open_page):
    asked: list[str] = []
    visit = open_page(None)
    page = visit.page
    page.on("request", lambda r: asked.append(r.url) if "/v1/robots/puma560" in r.url else None)
    visit.go("robot=ur5&q=0,-60,90,-120,-90,0&view=other:puma560")
    page.wait_for_function("() => document.querySelector('.host').probe.shown().other === 1")
    first = len(asked)
    assert first > 0
    slider = page.locator(".joint input[type=range]").nth(1)
    slider.focus()
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    visit.settled()
    assert len(asked) == first


def test_an_arm_that_was_turned_by_the_reader_stays_so_while_the_table_is_typed(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0")
    page = visit.page
    shown(visit)
    box = page.locator(".host canvas").bounding_box()
    page.mouse.move(box["x"] + 30, box["y"] + 30)
    page.mouse.down()
    page.mouse.move(box["x"] + 160, box["y"] + 60, steps=4)
    page.mouse.up()
    before = page.evaluate("() => document.querySelector('.host').probe.pixel('frame_0')")
    page.get_by_label("Row 4, d", exact=True).fill("0.45")
    page.wait_for_function(
        "() => Math.abs(document.querySelector('.host').probe.poses().frame_4[0][3]) > 0"
        " && location.hash.includes('table=')"
    )
    visit.settled()
    after = page.evaluate("() => document.querySelector('.host').probe.pixel('frame_0')")
    assert after == pytest.approx(before, abs=0.5)


def test_the_view_is_turned_by_keys_and_the_arm_is_not(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0")
    page = visit.page
    before = shown(visit)

    def pixels() -> np.ndarray:
        at = page.evaluate(
            "() => ['frame_0', 'frame_1', 'tool'].map(document.querySelector('.host').probe.pixel)"
        )
        return np.array([[one["x"], one["y"]] for one in at])

    page.locator(".host").focus()
    places = [pixels()]
    for key in ("ArrowLeft", "ArrowUp", "+", "-", "ArrowDown", "ArrowRight"):
        page.keyboard.press(key)
        places.append(pixels())
    for one, other in itertools.pairwise(places):
        assert np.abs(one - other).max() > 5
    assert np.abs(places[0] - places[-1]).max() < 0.5
    # Nearer is larger.
    spread = [np.ptp(one, axis=0).max() for one in places]
    assert spread[3] > 1.05 * spread[2]
    after = shown(visit)
    assert all(np.array_equal(before[name], after[name]) for name in before)
