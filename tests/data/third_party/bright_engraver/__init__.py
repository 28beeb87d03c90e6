"""A laser that engraves: each module adds one thing to gcodesim, and one line of `pyproject.toml` names it."""
