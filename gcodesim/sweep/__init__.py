"""Sweeps: a program in a cell, many times, each time with other values; one row a run."""
