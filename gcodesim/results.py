"""Metrics of a run: times, distances, volumes, forces and margins, in the form of `results.json`."""
