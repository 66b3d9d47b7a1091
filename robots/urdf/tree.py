"""Check that links and joints form one tree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from dh_to_urdf.messages import say
from robots.errors import InvalidURDF
from robots.urdf.description import URDFJoint
from robots.urdf.faults import Faults
from robots.urdf.values import Element


def check_names(kind: str, named: Sequence[tuple[str, Element]], faults: Faults) -> None:
    """Keep as faults two links, or two joints, of one name.

    Args:
        kind: link or joint.
        named: Names, each with its element.
        faults: Takes each name that stands twice, at its second place.
    """
    seen: dict[str, int] = {}
    for name, element in named:
        seen[name] = seen.get(name, 0) + 1
        if name and seen[name] == 2:
            faults.add(
                element,
                say(
                    "two {kind}s are called {name!r}; give each its own name", kind=kind, name=name
                ),
            )


def check_tree(
    links: Sequence[str],
    joints: Sequence[URDFJoint],
    faults: Faults,
    element_of: Callable[[URDFJoint], Element],
) -> str | None:
    """Check that every link but one has one parent and leads to the root.

    Args:
        links: Names of the links.
        joints: Joints whose links exist.
        faults: Takes the links and joints at fault.
        element_of: The element of a joint.

    Returns:
        The root link; None where it is no tree.
    """
    above: dict[str, URDFJoint] = {}
    twice = False
    for joint in joints:
        if joint.child in above:
            twice = True
            faults.add(
                element_of(joint),
                say(
                    "link {child!r} is the child of two joints, {above!r} and {joint!r}; a"
                    " robot is a tree",
                    child=joint.child,
                    above=above[joint.child].name,
                    joint=joint.name,
                ),
            )
        else:
            above[joint.child] = joint
    if twice:
        return None
    return faults.read(None, None, lambda: _root(links, above))


def _root(links: Sequence[str], above: Mapping[str, URDFJoint]) -> str:
    roots = [link for link in links if link not in above]
    if len(roots) > 1:
        shown = ", ".join(repr(link) for link in roots[:4])
        raise InvalidURDF(
            say(
                "the robot has {count} root links ({shown}); join them by a joint",
                count=len(roots),
                shown=shown,
            )
        )
    if not roots:
        raise InvalidURDF(
            say(
                "the joints form a loop ({loop}), and every link has a parent; a robot"
                " is a tree with one root",
                loop=_loop(above, links[0]),
            )
        )
    lead: set[str] = {roots[0]}
    for link in links:
        path: list[str] = []
        while link not in lead:
            if link in path:
                raise InvalidURDF(
                    say(
                        "link {link!r} is not connected to the root {root!r}: its joints form a"
                        " loop ({loop}); a robot is a tree",
                        link=link,
                        root=roots[0],
                        loop=_loop(above, link),
                    )
                )
            path.append(link)
            link = above[link].parent
        lead.update(path)
    return roots[0]


def _loop(above: Mapping[str, URDFJoint], link: str) -> str:
    """Return the names of the joints of the loop that a link leads into, from above."""
    seen: list[str] = []
    while link not in seen:
        seen.append(link)
        link = above[link].parent
    names = [above[other].name for other in seen[seen.index(link) :]]
    return ", ".join(repr(name) for name in names[:4]) + (", …" if len(names) > 4 else "")
