"""The layout of the arrays that the kernels of this package share.

There are few arrays, because each one is passed as eight words at every call. (No
kernel is here; the file's name makes these constants part of the hash of kernels.)
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
RESULT: Final = 103  # of the expression at hand, and a word's value
RETURNED: Final = 104  # by the last `return`
STACK: Final = 105  # of values while an expression is computed
MOST_VALUES: Final = 64
SETTINGS: Final = 169  # values of the line's `#index=value`, in order
ARGUMENTS: Final = 201  # values of the brackets behind an O-word
CYCLE_DWELL: Final = 231  # the last P of a cycle
ARC_ALWAYS: Final = 232  # how far the radii at both ends of an arc may differ: so much always, more than that never
ARC_MOST: Final = 233
SPEED: Final = 234  # the last S
NUMBERS: Final = 235

# modes: the state, what it will be after the line, what happened, codes in the line
MOTION: Final = 0
PLANE: Final = 1
INCREMENTAL: Final = 2
CENTRE_ABSOLUTE: Final = 3
FEED_MODE: Final = 4
ROTATED: Final = 5
INCH: Final = 6
HAS_SPEED: Final = 7
CYCLE: Final = 8  # the running canned cycle when the kernels know its words, else -1
RETRACT_TO_R: Final = 9  # G99
EXACT_PATH: Final = 10  # G61
COMPENSATES: Final = 11  # G41 or G42 is in force
SIDE: Final = 12  # to which the path is offset: +1 left, -1 right, 0 nowhere, as with a tool of radius 0
HAS_ENDPOINT: Final = 13
HELD_KIND: Final = 14
HELD_TURNS: Final = 15
HELD_ROTARY: Final = 16
HELD_PLACE: Final = 17  # line, column, end column, block, origin
WANTED: Final = 22  # motion, plane, incremental, centre absolute
ROWS: Final = 27
ARCS: Final = 28
ACTS: Final = 29
PLACE: Final = 30  # of the line at hand, as HELD_PLACE
ARC_TURNS: Final = 35  # of the arc at hand, negative for clockwise
JOIN: Final = 36  # how the move that waits meets the one at hand
CODES: Final = 37  # how many G words, then ten times each
MOST_CODES: Final = 8
# the program: where it is, and what its O-words and parameters did
NEXT: Final = 46  # index of the line to execute next, and of the last one executed
LAST: Final = 47
END: Final = 48  # after the last line of the file
LEVEL: Final = 49  # of calls: 0 in the main program; the lowest one since the kernel was called
LOWEST: Final = 50
LOOP: Final = 51  # index of the line last jumped back to, -1 for none
TAKEN: Final = 52  # as in `FlowControl`
BREAKING: Final = 53
CONTINUING: Final = 54
ARRIVED: Final = 55
HAS_RETURNED: Final = 56
IS_EXTENDED: Final = 57  # whether the dialect has what LinuxCNC added to RS274
FLOWS: Final = 58  # how many rows of O-words; negative while nobody has looked for them
FLOWS_WANTED: Final = -2
FLOWED: Final = 59  # what happened since the kernel was called: an O-word
NAMED: Final = 60  # a named parameter set
CALLED: Final = 61  # a call or return, which sets #1 to #30
CHANGED: Final = 62  # how many numbered parameters set
EPOCH: Final = 63  # of the latest call; a local value counts when it is of the epoch of its level
NAMES_USED: Final = 64
LETTERS_USED: Final = 65
CHAINS_USED: Final = 66
# the line at hand
NAME: Final = 67
MISSING: Final = 68  # EXISTS was asked of a name without a value
FRESH: Final = 69  # a name is set that has none
TEXT: Final = 70  # where an O-word begins
SET: Final = 71  # how many settings, then their targets: numbers, or names as -1 - name
MOST_SET: Final = 30
OPERATORS: Final = 102  # stack while an expression is computed
MOST_OPERATORS: Final = 64
FAILED: Final = 166  # whether the program is only read on for its further faults
RUNNING: Final = 167  # the running canned cycle, -1 for none
WANTS_R: Final = 168  # G99 after the line
STARTED: Final = 169  # a cycle began since the kernel was called, so the words of the one before are gone
# the dialect
PLAIN_LETTERS: Final = 170  # that plain lines have, as bits, bit 0 for A
COMPUTES: Final = 171  # whether it has parameters, expressions and O-words
HAS_CYCLES: Final = 172
ARCS_NAME_AXES: Final = 173
BY_START: Final = 174  # whether the radius of an arc is that at its start
# S beside a move: whether it is known, as all are but the first one and cutting speeds; whether one was executed
TAKES_S: Final = 175
S_SAID: Final = 176
MODES: Final = 177

# rows of moves: floats 0 to 5 the end, 6 the feed, and the S that an act says before it; integers:
MOVE_SPEED: Final = 7
MOVE: Final = 8
KIND: Final = 0
ROTARY: Final = 1
WORD: Final = 2  # number of the motion word, 81 for G81
LINE: Final = 3  # then column, end column, block and origin
FACTS: Final = 8

# rows of arcs: centre, normal, sweep, turns
SHAPE: Final = 8

# rows of acts between moves: the move they stand before, and which
EXACT: Final = 0
BACK: Final = 1
DWELL: Final = 2
S_WORD: Final = 3
MOST_ACTS_OF_LINE: Final = 3

MOST_ROWS_OF_LINE: Final = 2  # but for holes, which look for themselves

# memory: what `#` means. Numbered parameters by number, each level's #1 to #30 of its caller, then named ones:
# rows of the levels, last that of the global ones
MOST_LEVELS: Final = 10
MOST_NAMES: Final = 1024  # places; three quarters are used at most
LAST_NUMBER: Final = 5601
OF_CALL: Final = 30
KEPT: Final = 5602
NAMED_VALUES: Final = KEPT + MOST_LEVELS * OF_CALL
MEMORY: Final = NAMED_VALUES + (MOST_LEVELS + 1) * MOST_NAMES

# tables: rows of integers one after the other
FRAMES: Final = 0  # the stack of calls
FRAME: Final = 8
AT: Final = 0  # index of the line that is next there, kept while a call is out
SCOPE: Final = 1  # number of the subroutine's name
CHAIN: Final = 2  # number of the chain of callers
RETURNS: Final = 3  # whether `endsub` may be executed here
FIRST: Final = 4  # row of the `call` that made the frame
FRAME_EPOCH: Final = 5
FRAME_END: Final = 6
NAMES: Final = FRAMES + MOST_LEVELS * FRAME  # by hash: where in LETTERS, how long, of which kind
A_NAME: Final = 3
LOCAL: Final = 0
GLOBAL: Final = 1
UNKNOWN: Final = 2  # a predefined one that is asked of the other lane
POSITION_NAME: Final = 10  # then by axis
FEED_NAME: Final = 20
VALUE_NAME: Final = 21
VALUE_RETURNED_NAME: Final = 22
CALL_LEVEL_NAME: Final = 23
LETTERS: Final = NAMES + MOST_NAMES * A_NAME
MOST_LETTERS: Final = 16384
STAMPS: Final = LETTERS + MOST_LETTERS  # epoch of each named value
CHAINS: Final = STAMPS + (MOST_LEVELS + 1) * MOST_NAMES  # by hash: the caller's chain plus 1, row of the call
MOST_CHAINS: Final = 4096
CHANGES: Final = CHAINS + 2 * MOST_CHAINS  # numbered parameters that were set, each once
IS_CHANGED: Final = CHANGES + LAST_NUMBER + 1
FLOW_ROWS: Final = IS_CHANGED + LAST_NUMBER + 1  # lines with an O-word, in order
FLOW: Final = 14
FLOW_AT: Final = 0  # index of the line
KEYWORD: Final = 1  # 0 where the line is left
GROUP: Final = 2  # first row of the same label in the same subroutine; it keeps the label's state
BEHIND: Final = 3  # where the text after the keyword begins
FOLLOWING: Final = 4  # row of the next O-word of the label, -1 where the way there is left
FLOW_SCOPE: Final = 5  # subroutine in whose text it stands
SUB: Final = 6  # of a call: index of the line with `sub`, -1 when unknown, its scope, the end of its file
SUB_SCOPE: Final = 7
SUB_END: Final = 8
OPENED_BY: Final = 9  # state of the label: keyword, line that opened it, rounds left of a repeat or -1
OPENED_AT: Final = 10
LEFT: Final = 11
TOUCHED: Final = 12

# keywords
IF: Final = 1
ELSEIF: Final = 2
ELSE: Final = 3
ENDIF: Final = 4
WHILE: Final = 5
ENDWHILE: Final = 6
DO: Final = 7
REPEAT: Final = 8
ENDREPEAT: Final = 9
BREAK: Final = 10
CONTINUE: Final = 11
SUB_WORD: Final = 12
ENDSUB: Final = 13
RETURN: Final = 14
CALL: Final = 15
