"""Feeds that keep a cut within limits: runs of a program, and the program with other F words."""

from gcodesim.optimise.feeds import LIMITS, CannotOptimiseError, Limit, Optimised, limit_of, optimise_feeds

__all__ = ["LIMITS", "CannotOptimiseError", "Limit", "Optimised", "limit_of", "optimise_feeds"]
