"""Which bodies of the client touch each other, and which of their links."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations, product
from typing import Any, Final, Literal

import pybullet as p

BASE_LINK: Final = -1
MAX_DISTANCE_INTERNAL: Final = 0.0

Pair = tuple[int, int]
ALL: Final = "ALL"


class CollisionChecker:
    """Looks at the bodies `body_ids`, or at all that there are; those with a moving joint count as robots.

    Internal collisions are between links of one robot, external ones between two bodies, nearer than
    `max_distance_external` [m]. Either kind can be switched off.
    """

    def __init__(
        self,
        body_ids: Sequence[int] | None = None,
        max_distance_external: float = 0.0,
        enable_internal_collision: bool = True,
        enable_external_collision: bool = True,
    ) -> None:
        self.max_distance_external = max_distance_external
        self.enable_internal_collision = enable_internal_collision
        self.enable_external_collision = enable_external_collision
        self._bodies_information: list[dict[str, Any]] = []
        self._ignored_internal_collisions: list[tuple[int, list[Pair]]] = []
        self._ignored_external_collisions: list[tuple[Pair, list[Pair] | Literal["ALL"]]] = []
        for body in range(p.getNumBodies()):
            if body_ids is None or body in body_ids:
                self._learn(body)
        self._update()

    # ---- which bodies

    def make_robot_static(self, body_id: int) -> None:
        """Do not look for collisions between links of this body any more."""
        for body in self._of(body_id):
            body["body_type"] = "static_body"
        self._update()

    def remove_body_id(self, body_id: int) -> None:
        """Do not look at this body any more."""
        self._bodies_information = [body for body in self._bodies_information if body["body_id"] != body_id]
        self._update()

    def remove_link_id(self, body_id: int, link_id: int) -> None:
        """Do not look at this link any more, neither against its own body nor against others."""
        for body in self._of(body_id):
            body["collision_links"] = [link for link in body["collision_links"] if link != link_id]
            body["collision_pairs"] = list(combinations(body["collision_links"], 2))
        self._update()

    def add_body_id(self, body_id: int) -> None:
        """Look at this body too; a number that is no body, or is known already, changes nothing."""
        if 0 <= body_id < p.getNumBodies() and not any(self._of(body_id)):
            self._learn(body_id)
            self._update()

    # ---- what may touch

    def ignore_external_body_collision(self, body_pair: Pair) -> None:
        """Let two bodies touch."""
        pair = _sorted(body_pair)
        self._ignored_external_collisions = [(p_, l_) for p_, l_ in self._ignored_external_collisions if p_ != pair]
        self._ignored_external_collisions.append((pair, "ALL"))
        self._update()

    def ignore_external_link_collision(self, body_pair: Pair, ignored_link_pairs: Iterable[Pair]) -> None:
        """Let some links of two bodies touch: pairs of a link of the first and a link of the second of `body_pair`."""
        pair = _sorted(body_pair)
        links = [(a, b) if pair == tuple(body_pair) else (b, a) for a, b in ignored_link_pairs]
        known = dict(self._ignored_external_collisions)
        before = known.get(pair, [])
        known[pair] = ALL if before == ALL else list(dict.fromkeys([*before, *links]))
        self._ignored_external_collisions = list(known.items())
        self._update()

    def ignore_internal_link_collision(self, body_id: int, ignored_links: Iterable[int]) -> None:
        """Let some links of one robot touch each other, every one of them every other."""
        known = dict(self._ignored_internal_collisions)
        pairs = [*known.get(body_id, []), *combinations(sorted(ignored_links), 2)]
        known[body_id] = list(dict.fromkeys(pairs))
        self._ignored_internal_collisions = list(known.items())
        self._update()

    def clear_ignored_internal_collision(self) -> None:
        """Links of one robot may not touch any more."""
        self._ignored_internal_collisions = []
        self._update()

    def clear_ignored_external_collision(self) -> None:
        """Bodies may not touch any more."""
        self._ignored_external_collisions = []
        self._update()

    def set_safe_state(self) -> None:
        """What touches now may touch from now on."""
        self._update(heed=False)
        self._ignored_internal_collisions = self.get_internal_collisions()
        self._ignored_external_collisions = list(self.get_external_collisions())
        self._update()

    # ---- answers

    def is_collision_free(self) -> bool:
        """Whether nothing touches that may not."""
        return self.is_internal_collision_free() and self.is_external_collision_free()

    def is_internal_collision_free(self) -> bool:
        """Whether no robot touches itself; True where this kind is switched off."""
        return not (self.enable_internal_collision and any(True for _ in self._internal()))

    def is_external_collision_free(self) -> bool:
        """Whether no two bodies touch; True where this kind is switched off."""
        return not (self.enable_external_collision and any(True for _ in self._external()))

    def get_internal_collisions(self) -> list[tuple[int, list[Pair]]]:
        """Robots that touch themselves, each with the pairs of its links."""
        return _grouped(self._internal())

    def get_external_collisions(self) -> list[tuple[Pair, list[Pair]]]:
        """Pairs of bodies that touch, each with the pairs of links."""
        return _grouped(self._external())

    def get_external_distance(self, distance: float) -> float | None:
        """The least distance [m] between two bodies, None where all are further apart than `distance`."""
        least: float | None = None
        for (body, other), _ in self._external_collision_pairs:
            near = self.get_body_distance(body, other, distance)
            if near is not None:
                least = distance = near if least is None else min(least, near)
        return least

    def get_body_distance(self, bodyA: int, bodyB: int, distance: float) -> float | None:
        """The least distance [m] between two bodies, None where it is more than `distance` or nobody looks at them."""
        pairs = dict(self._external_collision_pairs).get(_sorted((bodyA, bodyB)), [])
        found = (self.get_distance(*_sorted((bodyA, bodyB)), distance, a, b) for a, b in pairs)
        return min((near for near in found if near is not None), default=None)

    @staticmethod
    def get_bodies_external_collisions(bodyA: int, bodyB: int, max_distance: float = 0.0) -> list[Pair]:
        """Pairs of links of two bodies that are nearer than `max_distance` [m], whatever may touch."""
        links = product(_links_of(bodyA), _links_of(bodyB))
        return [(a, b) for a, b in links if CollisionChecker.simple_collision(bodyA, bodyB, max_distance, a, b)]

    @staticmethod
    def has_moving_joint(body_id: int) -> bool:
        """Whether a joint of the body is not fixed."""
        return any(p.getJointInfo(body_id, j)[2] != p.JOINT_FIXED for j in range(p.getNumJoints(body_id)))

    @staticmethod
    def simple_collision(bodyA: int, bodyB: int, max_distance: float, linkA: int, linkB: int) -> bool:
        """Whether two links are nearer than `max_distance` [m]."""
        return bool(p.getClosestPoints(bodyA, bodyB, max_distance, linkIndexA=linkA, linkIndexB=linkB))

    @staticmethod
    def get_distance(bodyA: int, bodyB: int, distance: float, linkA: int, linkB: int) -> float | None:
        """The least distance [m] between two links, below zero where they overlap; None beyond `distance`."""
        points = p.getClosestPoints(bodyA, bodyB, distance, linkIndexA=linkA, linkIndexB=linkB)
        return min((point[8] for point in points), default=None)

    # ---- inside

    def _of(self, body_id: int) -> list[dict[str, Any]]:
        return [body for body in self._bodies_information if body["body_id"] == body_id]

    def _learn(self, body: int) -> None:
        links = _links_of(body)
        if links:
            information = {
                "body_id": body,
                "body_name": p.getBodyInfo(body)[1].decode("utf-8"),
                "body_type": "robot" if self.has_moving_joint(body) else "static_body",
                "collision_links": links,
                "collision_pairs": list(combinations(links, 2)),
            }
            self._bodies_information.append(information)

    def _update(self, *, heed: bool = True) -> None:
        """Which pairs to look at; what may touch counts only if one is to `heed` it."""
        inside = dict(self._ignored_internal_collisions) if heed else {}
        outside = dict(self._ignored_external_collisions) if heed else {}
        self._internal_collision_pairs = [
            (body["body_id"], _without(body["collision_pairs"], inside.get(body["body_id"], [])))
            for body in self._bodies_information
            if body["body_type"] == "robot"
        ]
        self._external_collision_pairs: list[tuple[Pair, list[Pair]]] = []
        for one, other in combinations(sorted(self._bodies_information, key=lambda body: int(body["body_id"])), 2):
            pair = (one["body_id"], other["body_id"])
            links = list(product(one["collision_links"], other["collision_links"]))
            self._external_collision_pairs.append((pair, _without(links, outside.get(pair, []))))

    def _internal(self) -> Iterable[tuple[int, Pair]]:
        for body, pairs in self._internal_collision_pairs:
            touching = (pair for pair in pairs if self.simple_collision(body, body, MAX_DISTANCE_INTERNAL, *pair))
            yield from ((body, pair) for pair in touching)

    def _external(self) -> Iterable[tuple[Pair, Pair]]:
        for (body, other), pairs in self._external_collision_pairs:
            touching = (pair for pair in pairs if self.simple_collision(body, other, self.max_distance_external, *pair))
            yield from (((body, other), pair) for pair in touching)


def _links_of(body: int) -> list[int]:
    """The links of a body that have a shape to collide with, its base among them."""
    return [link for link in range(BASE_LINK, p.getNumJoints(body)) if p.getCollisionShapeData(body, link)]


def _sorted(pair: Iterable[int]) -> Pair:
    low, high = sorted(pair)
    return low, high


def _without(pairs: Iterable[Pair], ignored: Sequence[Pair] | Literal["ALL"]) -> list[Pair]:
    return [] if ignored == ALL else [pair for pair in pairs if pair not in ignored]


def _grouped(found: Iterable[tuple[Any, Pair]]) -> list[tuple[Any, list[Pair]]]:
    groups: dict[Any, list[Pair]] = {}
    for key, pair in found:
        groups.setdefault(key, []).append(pair)
    return list(groups.items())
