"""The topics of a log, in the order in which messages of one time are written."""

from __future__ import annotations

from typing import Final

from gcodesim.frozen import frozen

MOST_TILES: Final = 16  # the layout names every tile topic, because a topic that it does not name stays hidden


@frozen(kw_only=False)
class Topic:
    """`often`: once (at time 0), period (each log period) or change (at time 0 and when the content changes)."""

    name: str
    schema: str
    often: str


PERIODIC: Final = (
    Topic("/tf", "foxglove.FrameTransforms", "period"),
    Topic("/joint_states", "foxglove.JointStates", "period"),
    Topic("/target", "foxglove.PoseInFrame", "period"),
    Topic("/tcp", "foxglove.PoseInFrame", "period"),
    Topic("/motion", "gcodesim.Motion", "period"),
    Topic("/process", "gcodesim.Process", "period"),
    Topic("/wrench", "gcodesim.Wrench", "period"),
)


DRAWN: Final = Topic("/scene/drawn", "foxglove.SceneUpdate", "change")
"""What a script draws; only logs of sessions have it."""


def tile_topic(family: str, index: int) -> str:
    """The topic of tile `index` of `stock` or `added`."""
    return f"/scene/{family}/{index:02d}"


LOOSE: Final = Topic(tile_topic("added", MOST_TILES - 1), "foxglove.SceneUpdate", "change")
"""Pieces that came loose; only logs of runs in an engine have it. The last tile, which every layout names."""


def topics_of_channel(name: str) -> tuple[Topic, ...]:
    """The topics of a further program that runs at the same time, in writing order: those of the first, with its name.

    What is there once, such as the stock, is with the first.
    """
    own = [*PERIODIC, *(topic for topic in topic_table(1, 0) if topic.name in OF_EACH)]
    return tuple(Topic(f"/{name}{topic.name}", topic.schema, topic.often) for topic in own)


OF_EACH: Final = ("/program", "/event", "/log", "/scene/path", "/scene/block", "/scene/tool", "/scene/force")
"""What each of several programs has besides the periodic topics."""


def topic_table(stock_tiles: int, added_tiles: int) -> tuple[Topic, ...]:
    """All topics of a log with that many tiles, in writing order. ValueError unless 1..16 and 0..16."""
    if not (1 <= stock_tiles <= MOST_TILES and 0 <= added_tiles <= MOST_TILES):
        raise ValueError(f"{stock_tiles} stock tiles and {added_tiles} added tiles; 1 to 16 and 0 to 16 are possible")
    scene = "foxglove.SceneUpdate"
    return (
        Topic("/tf_static", "foxglove.FrameTransforms", "once"),
        *PERIODIC,
        Topic("/program", "gcodesim.Program", "change"),
        Topic("/event", "gcodesim.Event", "change"),
        Topic("/log", "foxglove.Log", "change"),
        Topic("/scene/cell", scene, "once"),
        Topic("/scene/path", scene, "once"),
        Topic("/scene/block", scene, "change"),
        Topic("/scene/tool", scene, "change"),
        Topic("/scene/force", scene, "change"),
        *(Topic(tile_topic("stock", i), scene, "change") for i in range(stock_tiles)),
        *(Topic(tile_topic("added", i), scene, "change") for i in range(added_tiles)),
    )
