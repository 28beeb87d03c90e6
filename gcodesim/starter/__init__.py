"""What `gcodesim init` writes: the shipped example, or a first cell for an existing program."""
