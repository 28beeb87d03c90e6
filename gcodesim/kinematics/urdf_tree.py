"""The tree that the links and joints of a description make: order, flange, the joints that a program drives."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Joint, Link
from gcodesim.kinematics.xml_lines import Faults, LinedElement

FLANGE_NAMES: Final = ("tool0", "flange", "tcp")


@frozen
class LinkTree:
    """Links by name and joints from the root outwards; `driven` are the joints of q."""

    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    driven: tuple[int, ...]
    flange: str
    table: str | None


@frozen(kw_only=False)
class TreeReader:
    """Joins `links` and `joints`; findings stand at `places`, the elements by the name of a link or `joint NAME`.

    `key` is that of the cell which names the description. Links `between` joints of one body have no mass of their own.
    """

    root: LinedElement
    links: Mapping[str, Link]
    joints: list[Joint]
    places: Mapping[str, LinedElement | None]
    faults: Faults
    key: str = "urdf"
    between: frozenset[str] = frozenset()

    def tree(self, flange: str | None) -> LinkTree | None:
        """The tree with the link `flange` (default: by name, else the end of the longest chain); None if there is
        none."""
        ordered = self._ordered()
        if ordered is None:
            return None
        names = (self._root_name(), *(joint.child for joint in ordered))
        above = {joint.child: index for index, joint in enumerate(ordered)}
        known = flange or next((n for n in FLANGE_NAMES if n in names), None)
        end = known or _end(names, ordered, above)
        driven = _driven(ordered, above, end)
        table = "table" if "table" in above and _driven(ordered, above, "table") else None
        if table is not None:
            driven += [i for i in _driven(ordered, above, table) if i not in driven]
        if not driven:
            self._nothing_moves(names[0], end, ordered)
            return None
        if known is None:
            self.faults.find(
                "GS771",
                f"the tool hangs on link `{end}`, the end of the longest chain",
                self.places[end],
                f"if it belongs on another one, name that beside `{self.key}:`, as in"
                f" `flange: {ordered[above[end]].parent}`",
            )
        self._remark(ordered, driven)
        return LinkTree(links=names, joints=tuple(ordered), driven=tuple(driven), flange=end, table=table)

    def loose(self, flange: str | None) -> LinkTree | None:
        """The tree of something that is no robot: joints that follow others or are fixed are not driven."""
        ordered = self._ordered()
        if ordered is None:
            return None
        driven = tuple(i for i, joint in enumerate(ordered) if joint.kind != "fixed" and joint.mimic is None)
        root = self._root_name()
        names = (root, *(joint.child for joint in ordered))
        return LinkTree(links=names, joints=tuple(ordered), driven=driven, flange=flange or root, table=None)

    def _root_name(self) -> str:
        children = {joint.child for joint in self.joints}
        return next(name for name in self.links if name not in children)

    def _ordered(self) -> list[Joint] | None:
        """Joints from the root outwards, breadth first and else in the order of the file; None if they make no tree."""
        children = {joint.child for joint in self.joints}
        roots = [name for name in self.links if name not in children]
        if not self.links:
            hint = "a file that only includes others is for xacro: expand it first"
            self.faults.find("GS764", "this robot has no links", self.root, hint)
            return None
        if len(roots) != 1:
            what = ", ".join(f"`{r}`" for r in roots) or "none (a ring of joints)"
            hint = "join the others to it by a joint of type `fixed`" if roots else "one link must be no joint's child"
            self.faults.find("GS764", f"a robot has one root link; this one has {what}", self.root, hint)
            return None
        below: dict[str, list[Joint]] = {}
        for joint in self.joints:
            below.setdefault(joint.parent, []).append(joint)
        ordered: list[Joint] = list(below.get(roots[0], []))
        for joint in ordered:  # grows while it is walked
            ordered += below.get(joint.child, [])
        if len(ordered) < len(self.joints):
            reached = {roots[0], *(joint.child for joint in ordered)}
            lost = ", ".join(f"`{name}`" for name in self.links if name not in reached)
            hint = f"join one of them to `{roots[0]}` or to a link below it"
            self.faults.find("GS764", f"the links {lost} hang on each other, not on the root", self.root, hint)
            return None
        return ordered

    def _nothing_moves(self, root: str, flange: str, ordered: list[Joint]) -> None:
        if any(joint.kind != "fixed" for joint in ordered):
            hint = f"write `flange:` with the name of the link that carries the tool beside `{self.key}:`"
        else:
            hint = "a body that nothing moves is a fixture: `fixtures: {NAME: {mesh: FILE}}`"
        self.faults.find(
            "GS767", f"no joint between the root `{root}` and the flange `{flange}` can move", self.root, hint
        )

    def _remark(self, ordered: list[Joint], driven: list[int]) -> None:
        """Findings about a tree that holds together: followers in the chain, idle joints, links without mass."""
        heavy = self._heavy(ordered)
        chain = set(driven)
        without: list[Joint] = []
        for index, joint in enumerate(ordered):
            at = self.places[f"joint {joint.name}"]
            if index in chain:
                if joint.mimic is not None:
                    message = f"joint `{joint.name}` follows `{joint.mimic[0]}`"
                    hint = f"the tool may hang on a link before it: `flange: {joint.parent}` beside `{self.key}:`"
                    self.faults.find("GS766", f"{message}; followers inside the chain are not simulated", at, hint)
                elif joint.child not in heavy and joint.child not in self.between:
                    without.append(joint)
            elif joint.kind != "fixed":
                follows = f", follows `{joint.mimic[0]}`" if joint.mimic is not None else ""
                message = f"joint `{joint.name}` is not on the way to the flange{follows}: it stands at zero"
                self.faults.find("GS768", message, at)
        if without:
            one = f"link `{without[0].child}` has no mass: joint efforts leave it out"
            all_of_them = ", ".join(f"`{joint.child}`" for joint in without)
            several = f"{len(without)} links have no mass, and joint efforts leave them out: {all_of_them}"
            at = self.places[f"joint {without[0].name}"]
            self.faults.find("GS769", one if len(without) == 1 else several, at)

    def _heavy(self, ordered: list[Joint]) -> set[str]:
        """Links that weigh anything, alone or with what is fixed to them."""
        heavy = {name for name, link in self.links.items() if link.inertial is not None and link.inertial.mass > 0.0}
        for joint in reversed(ordered):
            if joint.kind == "fixed" and joint.child in heavy:
                heavy.add(joint.parent)
        return heavy


def _driven(joints: list[Joint], above: Mapping[str, int], link: str) -> list[int]:
    """Indices of the movable joints from the root to `link`."""
    found: list[int] = []
    while link in above:
        index = above[link]
        if joints[index].kind != "fixed":
            found.append(index)
        link = joints[index].parent
    return found[::-1]


def _end(names: tuple[str, ...], joints: list[Joint], above: Mapping[str, int]) -> str:
    """The end of the longest chain that moves and in which no joint follows another one; else of the longest."""
    free, moves, depth = {names[0]: True}, {names[0]: False}, {names[0]: 0}
    for name in names[1:]:
        joint = joints[above[name]]
        free[name] = free[joint.parent] and joint.mimic is None
        moves[name] = moves[joint.parent] or joint.kind != "fixed"
        depth[name] = depth[joint.parent] + 1
    return max(names, key=lambda name: (free[name] and moves[name], depth[name]))
