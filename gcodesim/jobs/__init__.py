"""A job and what comes of it: a program in a cell, its legs, what is seen to be wrong, results."""
