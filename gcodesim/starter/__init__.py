"""What `gcodesim init` writes: the example that ships, or a first cell for a program that is there."""
