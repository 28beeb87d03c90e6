"""Going on with a program at one of its lines, as after a broken tool: what a control has to be told before."""
