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
ARC_CENTRE: Final = 42  # of the arc at hand, in the plane
# cutter compensation: the move that waits for the next corner (`compensation.Held`), and what the corner asks for
RADIUS: Final = 44
NORMAL: Final = 45
ENDPOINT: Final = 47
EMITTED: Final = 49
HELD_END: Final = 55
HELD_DIRECTION: Final = 61
HELD_CENTRE: Final = 63
HELD_SWEEP: Final = 65
HELD_FEED: Final = 66
NEXT_START: Final = 67  # the move at hand, offset: start, end, direction, normal at its end; CORNER ends the other
NEXT_END: Final = 69
NEXT_DIRECTION: Final = 71
NEXT_NORMAL: Final = 73
CORNER: Final = 75
VALUES: Final = 77  # of the letters A to Z in the line
NUMBERS: Final = 103

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
COMPENSATES: Final = 11  # G41 or G42 is in force
SIDE: Final = 12  # to which the path is offset: +1 left, -1 right, 0 nowhere, as with a tool of radius 0
HAS_ENDPOINT: Final = 13
HELD_KIND: Final = 14
HELD_TURNS: Final = 15
HELD_ROTARY: Final = 16
HELD_PLACE: Final = 17  # line, column, end column
WANTED: Final = 20  # motion, plane, incremental, centre absolute
MOVED: Final = 24
ROWS: Final = 25
ARCS: Final = 26
ACTS: Final = 27
PLACE: Final = 28  # of the line at hand, as HELD_PLACE
ARC_TURNS: Final = 31  # of the arc at hand, negative for clockwise
JOIN: Final = 32  # how the move that waits meets the one at hand
CODES: Final = 33  # how many G words, then ten times each
MOST_CODES: Final = 8
MODES: Final = 42

# rows of moves: floats 0 to 5 the end, 6 the feed; integers:
END_FEED: Final = 7
KIND: Final = 0
ROTARY: Final = 1
WORD: Final = 2  # number of the motion word, 81 for G81
LINE: Final = 3  # then column and end column
FACTS: Final = 6

# rows of arcs: centre, normal, sweep, turns
SHAPE: Final = 8

# rows of acts between moves: the move they stand before, and which
EXACT: Final = 0
BACK: Final = 1
DWELL: Final = 2
MOST_ACTS_OF_LINE: Final = 3

MOST_ROWS_OF_LINE: Final = 2  # but for holes, which look for themselves
