"""Random URDFs that are right: any tree, any joint, every element that is read or left out."""

from __future__ import annotations

import random
from xml.sax.saxutils import quoteattr

NAMES = ("arm", "link 1", "épaule", "L&R", "a<b", "it's", "x.y-z_0", "手", "Ж", "0")
TYPES = ("revolute", "revolute", "revolute", "prismatic", "continuous", "fixed", "fixed")
BESIDE = (
    "<gazebo><plugin name='x'>text</plugin></gazebo>",
    '<transmission name="t"><joint name="j"/></transmission>',
    "<ros2_control><joint/></ros2_control>",
    "<!-- a <link> in a comment -->",
    "<?editor fold?>",
    "<sensor/>",
)
NUMBERS = ("0", "1", "-1", "0.5", "1e-3", "+2", ".25", "3.", "-0.0", "1.5707963267948966", "1E1")


def random_urdf(rng: random.Random, joints: int | None = None) -> str:
    """A URDF that the gate must read."""
    count = rng.choice((1, 2, 2, 3, 3, 4, 5, 8, 12)) if joints is None else joints
    stem = rng.choice(NAMES)
    links = [f"{stem}{k}" if k else stem for k in range(count + 1)]
    rng.shuffle(links)
    order = rng.choice(("chain", "star", "any"))
    bodies = [_link(rng, name) for name in links]
    types = [rng.choice(TYPES) for _ in range(count)]
    if all(kind == "fixed" for kind in types):
        types[rng.randrange(count)] = "revolute"
    arms = []
    for k in range(1, count + 1):
        parent = {"chain": k - 1, "star": 0, "any": rng.randrange(k)}[order]
        arms.append(_joint(rng, f"j{stem}{k}", types[k - 1], links[parent], links[k]))
    parts = [*bodies, *arms, *rng.choices(BESIDE, k=rng.randrange(3))]
    if rng.random() < 0.5:
        rng.shuffle(parts)
    declared = rng.choice(("", '<?xml version="1.0"?>', '<?xml version="1.0" encoding="UTF-8"?>\n'))
    gap = rng.choice(("", "\n  "))
    return f"{declared}<robot name={quoteattr(stem)}>{gap}{gap.join(parts)}</robot>\n"


def number(rng: random.Random) -> str:
    """A number as people write it."""
    return rng.choice(NUMBERS) if rng.random() < 0.5 else repr(rng.uniform(-2, 2))


def numbers(rng: random.Random, count: int = 3) -> str:
    """Several numbers between blanks."""
    return rng.choice((" ", "  ", "\n")).join(number(rng) for _ in range(count))


def axis(rng: random.Random) -> str:
    """A direction: along an axis of the joint, or any."""
    if rng.random() < 0.5:
        return rng.choice(("1 0 0", "0 1 0", "0 0 1", "0 0 -1", "-1 0 0", "0 2 0"))
    return " ".join(repr(rng.choice((-1, 1)) * rng.uniform(0.1, 3)) for _ in range(3))


def _origin(rng: random.Random) -> str:
    if rng.random() < 0.2:
        return ""
    xyz = f' xyz="{numbers(rng)}"' if rng.random() < 0.9 else ""
    rpy = f" rpy='{numbers(rng)}'" if rng.random() < 0.7 else ""
    return f"<origin{xyz}{rpy}/>"


def _link(rng: random.Random, name: str) -> str:
    inside = []
    if rng.random() < 0.3:
        inside.append(
            f'<inertial>{_origin(rng)}<mass value="{rng.choice(("0", "1", "2.5"))}"/>'
            '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0.1" izz="1"/></inertial>'
        )
    for kind in rng.choices(("visual", "collision"), k=rng.choice((0, 0, 1, 2))):
        form = rng.choice(
            (
                '<box size="1 2 3"/>',
                '<cylinder radius="1" length="0.1"/>',
                '<sphere radius=".1"/>',
                '<mesh filename="package://a/b.stl"/>',
                '<mesh filename="/etc/passwd" scale="1 1 1"/>',
            )
        )
        paint = '<material name="m"><color rgba="1 0 0 1"/></material>'
        paint = paint if rng.random() < 0.3 else ""
        inside.append(f"<{kind}>{_origin(rng)}<geometry>{form}</geometry>{paint}</{kind}>")
    return f"<link name={quoteattr(name)}>{''.join(inside)}</link>"


def _joint(rng: random.Random, name: str, kind: str, parent: str, child: str) -> str:
    parts = [f"<parent link={quoteattr(parent)}/>", f"<child link={quoteattr(child)}/>"]
    parts.append(_origin(rng))
    if kind != "fixed" and rng.random() < 0.9:
        parts.append(f'<axis xyz="{axis(rng)}"/>')
    if kind in ("revolute", "prismatic"):
        lower = rng.uniform(-3, 1)
        upper = rng.choice((lower, lower + rng.random(), 1e16))
        parts.append(
            f'<limit lower="{lower!r}" upper="{upper!r}" effort="{rng.choice(("0", "10"))}"'
            ' velocity="1.5"/>'
        )
    if rng.random() < 0.2:
        parts.append('<dynamics damping="1"/>')
    rng.shuffle(parts)
    return f'<joint name={quoteattr(name)} type="{kind}">{"".join(parts)}</joint>'
