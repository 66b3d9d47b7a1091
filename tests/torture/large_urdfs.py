"""The largest documents that the gate lets through, each at another cap, and some far beyond."""

LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
SHAPE = '<visual><origin xyz="1 2 3" rpy="1 2 3"/><geometry><box size="1 1 1"/></geometry></visual>'
LONG = "\U00010348" * 120
"""A letter of four bytes, as often as a name may hold it, with room for a number."""


def tree(links, parent_of, *, moving=64, name="", inside="", beside=""):
    """Links 0 to ``links - 1``; the first joints move."""
    parts = [f'<robot name="large"><link name="l{name}0">{inside}</link>']
    for k in range(1, links):
        kind = "revolute" if k <= moving else "fixed"
        parts.append(
            f'<link name="l{name}{k}"/><joint name="j{name}{k}" type="{kind}">'
            f'<parent link="l{name}{parent_of(k)}"/><child link="l{name}{k}"/>'
            f'<origin xyz="0.1 0.2 0.3" rpy="0.1 0.2 0.3"/><axis xyz="0 1 1"/>{LIMIT}</joint>'
        )
    return "".join([*parts, beside, "</robot>"])


def chain(links=300, **options):
    return tree(links, lambda k: k - 1, **options)


def star(links=300, **options):
    return tree(links, lambda _k: 0, **options)


def filled(document, piece, size=2_000_000):
    """A document with as many of a piece before its end as it may hold."""
    room = size - len(document.encode())
    return document.replace("</robot>", piece * (room // len(piece.encode())) + "</robot>")


def largest():
    """Documents that pass, by the cap that each is at."""
    attributes = " ".join(f'a{k}="1"' for k in range(31))
    mesh = f'<visual><geometry><mesh filename="package://{"m" * 480}"/></geometry></visual>'
    return {
        "chain": chain(),
        "chain of long names": chain(name=LONG),
        "hand": tree(300, lambda k: max(0, k - 5), moving=200),
        "star": star(),
        "comb": tree(300, lambda k: k - 1 if k % 2 else max(0, k - 2)),
        "shapes": chain(inside=SHAPE * 1400),
        "meshes": chain(inside=mesh * 1000),
        "materials": chain(
            beside="".join(
                f'<material name="{LONG}{k}"><color rgba="1 1 1 1"/></material>' for k in range(300)
            )
        ),
        "elements": chain(beside=f"<gazebo>{'<x/>' * 17_000}</gazebo>"),
        "attributes": chain(beside=f"<gazebo>{f'<x {attributes}/>' * 7_500}</gazebo>"),
        "unknown": chain(beside="<controller/>" * 17_000),
        "depth": chain(beside=f"<gazebo>{'<x>' * 250}{'</x>' * 250}</gazebo>"),
        "comments": filled(chain(), "<!-- -->"),
        "blanks": filled(chain(), "\n"),
    }


def too_large():
    """Documents that are refused for their size, and the words of the refusal."""
    many = " ".join(f'a{k}="1"' for k in range(100_000))
    small = chain(3)
    collision = '<collision><geometry><sphere radius="1"/></geometry></collision>'
    name = "\U00010348" * 483
    far = f'<visual><geometry><mesh filename="package://{name}"/></geometry></visual>'
    return {
        "bytes": (filled(small, "\n") + "\n" * 2_000_000, "2000000 are read"),
        "attributes": (small.replace("<axis", f"<axis {many}", 1), "attributes; at most 32"),
        "attributes of robot": (small.replace("<robot", f"<robot {many}", 1), "at most 32"),
        "elements": (filled(small, "<a/>"), "elements; at most 20000"),
        "links": (filled(small, "<link name='a'/>"), "elements; at most 20000"),
        "links within the elements": (chain(2500), "2500 links; at most 300"),
        "star of 10,000 joints": (star(10_000, moving=10_000), "2000000 are read"),
        "star of 9,000 joints": (star(9_000, moving=9_000), "elements; at most 20000"),
        "joints": (
            chain(300).replace("</robot>", '<joint name="x" type="fixed"/>' * 99 + "</robot>"),
            "398 joints; at most 300",
        ),
        "moving joints": (chain(66, moving=65), "65 joints; at most 64"),
        "collisions": (chain(3, inside=collision * 25_000), "elements; at most 20000"),
        "canonical bytes": (chain(3, inside=far * 1000), "when its numbers are written out"),
    }
