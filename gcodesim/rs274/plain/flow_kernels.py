"""O-words on arrays: `rs274/flow.py` in compiled form, for what has a row in the table of O-words.

Where a control would refuse an O-word, or something outside the tables is needed
(another file, M70, a subroutine that nobody has looked for yet), the line is left and nothing is changed.
"""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.expression_kernels import value_at
from gcodesim.rs274.plain.layout_kernels import (
    ARGUMENTS,
    ARRIVED,
    AT,
    BEHIND,
    BREAK,
    BREAKING,
    CALL,
    CALLED,
    CHAIN,
    CHAINS,
    CHAINS_USED,
    CONTINUING,
    DO,
    ELSE,
    ELSEIF,
    END,
    ENDIF,
    ENDREPEAT,
    ENDSUB,
    ENDWHILE,
    FAILED,
    FIRST,
    FLOW,
    FLOW_AT,
    FLOW_ROWS,
    FLOW_SCOPE,
    FLOWED,
    FLOWS,
    FOLLOWING,
    FRAME,
    FRAME_END,
    FRAMES,
    GROUP,
    HAS_RETURNED,
    IF,
    KEPT,
    KEYWORD,
    LEFT,
    LEVEL,
    LOOP,
    LOWEST,
    MOST_CHAINS,
    MOST_LEVELS,
    NEXT,
    OF_CALL,
    OPENED_AT,
    OPENED_BY,
    REPEAT,
    RESULT,
    RETURN,
    RETURNED,
    RETURNS,
    SCOPE,
    SUB,
    SUB_END,
    SUB_SCOPE,
    SUB_WORD,
    TAKEN,
    TOUCHED,
    WHILE,
)
from gcodesim.rs274.plain.parameter_kernels import forget_names
from gcodesim.rs274.plain.reader_kernels import behind_comment
from gcodesim.rs274.plain.text_kernels import behind_blanks

_MOST_CHAINS_USED = MOST_CHAINS - MOST_CHAINS // 4


@kernel
def o_word(text: Column, index: int, stop: int, numbers: Column, modes: Column, memory: Column, tables: Column) -> bool:
    """Execute the O-word of line `index`; NEXT says where to go on. False when the line is left."""
    row = _row_of(index, modes, tables)
    if row < 0:
        return False
    flow = FLOW_ROWS + FLOW * row
    keyword = tables[flow + KEYWORD]
    frame = FRAMES + FRAME * modes[LEVEL]
    if keyword == 0 or (keyword < SUB_WORD and tables[flow + FLOW_SCOPE] != tables[frame + SCOPE]):
        return False
    count = _operands(text, tables[flow + BEHIND], stop, numbers, modes, memory, tables)
    if count < 0:
        return False
    if keyword == CALL:
        done = _call(flow, row, index, count, numbers, modes, memory, tables)
    elif keyword in (RETURN, ENDSUB):
        done = count <= 1 and _return(count, numbers, modes, memory, tables)
    elif keyword == SUB_WORD:  # one inside another is passed through
        done = count == 0 and modes[LEVEL] > 0 and tables[frame + RETURNS] != 0
        modes[NEXT] = index + 1
    else:
        done = _jump(flow, keyword, index, count, numbers, modes, tables)
    if not done:
        return False
    if keyword >= SUB_WORD:
        modes[ARRIVED] = 0
    modes[FLOWED] = 1
    return True


@kernel
def _row_of(index: int, modes: Column, tables: Column) -> int:
    """The row of the O-word in line `index`; -1 when there is none."""
    low, high = 0, modes[FLOWS]
    while low < high:
        middle = (low + high) // 2
        if tables[FLOW_ROWS + FLOW * middle + FLOW_AT] < index:
            low = middle + 1
        else:
            high = middle
    if low < modes[FLOWS] and tables[FLOW_ROWS + FLOW * low + FLOW_AT] == index:
        return low
    return -1


@kernel
def _operands(text: Column, at: int, stop: int, numbers: Column, modes: Column, memory: Column, tables: Column) -> int:
    """Compute the bracketed expressions after the keyword; returns how many there are, -1 if the line is left."""
    count = 0
    while True:
        at = behind_blanks(text, at, stop)
        if at >= stop:
            return count
        if text[at] == 40 or text[at] == 59:
            at = behind_comment(text, at, stop)
        elif text[at] == 91 and count < OF_CALL:
            at = value_at(text, at, stop, numbers, modes, memory, tables)
            numbers[ARGUMENTS + count] = numbers[RESULT]
            count += 1
        else:
            return -1
        if at < 0:
            return -1


@kernel
def _jump(flow: int, keyword: int, index: int, count: int, numbers: Column, modes: Column, tables: Column) -> bool:
    """Branches and loops."""
    asks = keyword in (IF, ELSEIF, WHILE, REPEAT)
    if count != (1 if asks else 0):
        return False
    holds = asks and numbers[ARGUMENTS] != 0.0
    label = FLOW_ROWS + FLOW * tables[flow + GROUP]
    opened = tables[label + OPENED_BY]
    can_skip = tables[flow + FOLLOWING] >= 0
    arrived = modes[ARRIVED] != 0
    skips = False
    goes_back = False
    if keyword == IF:
        if not _may_open(label, keyword, index, tables) or not (holds or can_skip):
            return False
        _open(label, keyword, index, tables)
        modes[TAKEN] = holds
        skips = not holds
    elif keyword in (ELSEIF, ELSE, ENDIF):
        skips = keyword != ENDIF and modes[TAKEN] != 0
        if keyword == ELSEIF and not modes[TAKEN] and not holds:
            skips = True
        if opened != IF or (skips and not can_skip):
            return False
        if keyword == ENDIF:
            modes[TAKEN] = 1
        elif not modes[TAKEN]:
            modes[TAKEN] = holds if keyword == ELSEIF else arrived
    elif keyword == WHILE:
        if opened == DO:
            goes_back = holds and not modes[BREAKING]
            modes[BREAKING] = 0
        else:
            skips = not holds
            if not _may_open(label, keyword, index, tables) or (skips and not can_skip):
                return False
            _open(label, keyword, index, tables)
    elif keyword == DO:
        if not _may_open(label, keyword, index, tables):
            return False
        _open(label, keyword, index, tables)
    elif keyword == REPEAT:
        known, left = _rounds_left(label, opened, numbers, tables)
        if not known:
            return False
        skips = left <= 0
        if not _may_open(label, keyword, index, tables) or (skips and not can_skip):
            return False
        _open(label, keyword, index, tables)
        tables[label + LEFT] = -1 if skips else left - 1
    elif keyword in (ENDWHILE, ENDREPEAT):
        if opened != (WHILE if keyword == ENDWHILE else REPEAT):
            return False
        goes_back = not arrived or modes[CONTINUING] != 0
        if arrived:
            modes[CONTINUING] = 0
    else:  # break, continue
        if (opened != WHILE and opened != DO) or not can_skip:
            return False
        skips = True
        if keyword == BREAK:
            modes[BREAKING] = 1
        elif not arrived:
            modes[CONTINUING] = 1
    if skips:
        modes[NEXT] = tables[FLOW_ROWS + FLOW * tables[flow + FOLLOWING] + FLOW_AT]
    elif goes_back and not modes[FAILED]:
        modes[NEXT] = modes[LOOP] = tables[label + OPENED_AT]
    else:
        modes[NEXT] = index + 1
    modes[ARRIVED] = skips
    return True


@kernel(inlined=True)
def _rounds_left(label: int, opened: int, numbers: Column, tables: Column) -> tuple[bool, int]:
    """How many rounds of a `repeat` are left; False when that is no whole number."""
    rounds = numbers[ARGUMENTS]
    left = tables[label + LEFT] if opened == REPEAT else -1
    if left < 0:
        if np.floor(rounds) != rounds or abs(rounds) > 1e15:
            return False, 0
        left = int(rounds)
    return True, left


@kernel
def _may_open(label: int, keyword: int, index: int, tables: Column) -> bool:
    known: int = tables[label + OPENED_BY]
    return known == 0 or tables[label + OPENED_AT] == index


@kernel
def _open(label: int, keyword: int, index: int, tables: Column) -> None:
    if tables[label + OPENED_BY] == 0:
        tables[label + OPENED_BY], tables[label + OPENED_AT], tables[label + LEFT] = keyword, index, -1
    tables[label + TOUCHED] = 1


@kernel
def _call(
    flow: int, row: int, index: int, count: int, numbers: Column, modes: Column, memory: Column, tables: Column
) -> bool:
    level = modes[LEVEL]
    first = tables[flow + SUB]
    if first < 0 or level + 1 >= MOST_LEVELS:
        return False
    caller = FRAMES + FRAME * level
    chain = _chain(tables[caller + CHAIN], row, modes, tables)
    if chain < 0:
        return False
    tables[caller + AT] = index + 1
    level += 1
    modes[LEVEL] = level
    frame = FRAMES + FRAME * level
    tables[frame + SCOPE], tables[frame + CHAIN] = tables[flow + SUB_SCOPE], chain
    tables[frame + RETURNS], tables[frame + FIRST] = 1, row
    tables[frame + FRAME_END] = tables[flow + SUB_END]
    modes[END] = tables[flow + SUB_END]
    for each in range(OF_CALL):
        memory[KEPT + OF_CALL * level + each] = memory[1 + each]
        memory[1 + each] = numbers[ARGUMENTS + each] if each < count else 0.0
    forget_names(modes, tables)
    modes[CALLED] = 1
    numbers[RETURNED], modes[HAS_RETURNED] = 0.0, 0
    modes[NEXT] = first
    return True


@kernel
def _return(count: int, numbers: Column, modes: Column, memory: Column, tables: Column) -> bool:
    level = modes[LEVEL]
    if level == 0 or not tables[FRAMES + FRAME * level + RETURNS]:
        return False
    for each in range(OF_CALL):
        memory[1 + each] = memory[KEPT + OF_CALL * level + each]
    level -= 1
    modes[LEVEL] = level
    modes[LOWEST] = min(modes[LOWEST], level)
    frame = FRAMES + FRAME * level
    modes[NEXT], modes[END] = tables[frame + AT], tables[frame + FRAME_END]
    modes[CALLED] = 1
    numbers[RETURNED] = numbers[ARGUMENTS] if count == 1 and numbers[ARGUMENTS] != 0.0 else 0.0
    modes[HAS_RETURNED] = count
    return True


@kernel
def _chain(parent: int, row: int, modes: Column, tables: Column) -> int:
    """The number of the chain of callers that a call makes; -1 when there is no room for a new one."""
    chain = (parent * 31 + row) % MOST_CHAINS
    while tables[CHAINS + 2 * chain] != 0:
        if tables[CHAINS + 2 * chain] == parent + 1 and tables[CHAINS + 2 * chain + 1] == row:
            return chain
        chain = (chain + 1) % MOST_CHAINS
    if modes[CHAINS_USED] >= _MOST_CHAINS_USED:
        return -1
    modes[CHAINS_USED] += 1
    tables[CHAINS + 2 * chain], tables[CHAINS + 2 * chain + 1] = parent + 1, row
    return chain
