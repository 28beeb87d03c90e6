"""Shipped machines for the cell: chains with limits, and what a URDF cannot say."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Literal

from gcodesim.declarations.reading import Path as KeyPath
from gcodesim.declarations.reading import Reading, Unread, suggestion

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Chain
    from gcodesim.kinematics.models import ShippedModel


def shipped(name: str, kind: Literal["arm", "machine"], to: Reading, path: KeyPath) -> ShippedModel | Unread:
    """The shipped model of this name, or a finding that names similar ones."""
    from gcodesim.kinematics.models import MODELS

    model: ShippedModel | None = MODELS.get(name)
    if model is not None and model.kind == kind:
        return model
    span = to.span(path)
    if model is not None:
        right = (
            f"write `machine: {name}`"
            if model.kind == "machine"
            else f"write it under `robots:`, as `arm: {{model: {name}}}`"
        )
        what = "a machine tool" if model.kind == "machine" else "a robot arm"
        return to.fault("GS712", span, f"`{name}` is {what}", right)
    known = [m.name for m in MODELS.values() if m.kind == kind]
    what = "machine" if kind == "machine" else "robot"
    return to.fault("GS712", span, f"no {what} model `{name}` ships with gcodesim", suggestion(name, known))


@cache
def shipped_chain(name: str) -> Chain:
    """The chain of a shipped model."""
    from gcodesim.kinematics.models import model_path
    from gcodesim.kinematics.urdf import load_urdf

    chain, findings = load_urdf(model_path(name))
    if chain is None:
        raise RuntimeError(f"the shipped model {name} is broken: {findings}")
    return chain
