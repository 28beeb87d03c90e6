"""Where things stand in the arrays that the kernels of this package share.

Few arrays, because each one is passed on with eight words at every call. (No
kernel stands here; the name puts these constants under the hash of kernels.)
"""

from __future__ import annotations

from typing import Final

# numbers: points X Y Z A B C in program units and degrees, then single values
CURRENT: Final = 0
G92: Final = 6
ORIGIN: Final = 12
TARGET: Final = 18  # a point to work with
MIDDLE: Final = 24  # another one
COS: Final = 30
SIN: Final = 31
UNIT: Final = 32
FEED: Final = 33
FEED_UNIT: Final = 34
DEG: Final = 35
MINUTE: Final = 36
CYCLE_START: Final = 37  # canned cycles: height at which the chain began, and its words
CYCLE_R: Final = 38
CYCLE_DEPTH: Final = 39
CYCLE_Q: Final = 40
CYCLE_P: Final = 41
VALUES: Final = 42  # of the letters A to Z in the line
NUMBERS: Final = 68

# modes: the state, what it will be after the line, what happened, codes in the line
MOTION: Final = 0
PLANE: Final = 1
INCREMENTAL: Final = 2
CENTRE_ABSOLUTE: Final = 3
FEED_MODE: Final = 4
ROTATED: Final = 5
INCH: Final = 6
HAS_SPEED: Final = 7
CYCLE: Final = 8  # the running canned cycle when the kernels know it, else -1
RETRACT_TO_R: Final = 9  # G99
EXACT_PATH: Final = 10  # G61
WANTED: Final = 11  # motion, plane, incremental, centre absolute
MOVED: Final = 15
ROWS: Final = 16
ARCS: Final = 17
ACTS: Final = 18
CODES: Final = 19  # how many G words, then ten times each
MOST_CODES: Final = 8
MODES: Final = 28

# rows of moves: floats 0 to 5 the end, 6 the feed; integers:
END_FEED: Final = 7
KIND: Final = 0
ROTARY: Final = 1
WORD: Final = 2  # number of the motion word, 81 for G81
LINE: Final = 3
COLUMN: Final = 4
END_COLUMN: Final = 5
FACTS: Final = 6

# rows of arcs: centre, normal, sweep, turns
SHAPE: Final = 8

# rows of acts between moves: the move they stand before, and which
EXACT: Final = 0
BACK: Final = 1
DWELL: Final = 2
MOST_ACTS_OF_LINE: Final = 3
