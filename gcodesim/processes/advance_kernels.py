"""How far a tool that gives way really advances in a step: the chip is as thick as that, not as the command says.

While a cut grows the tip is pushed back against the feed, so that it advances less than commanded and its chips are
thinner; while the cut fades the bend is worked off through thicker ones. Without this a soft machine would be bent
faster than it is fed, and dig itself in without ever moving on.

Where the feed turns, the tip does not turn at once: its bend has to swing round with the force, and it can do so only
by cutting its way. It travels on a curve of the size of its bend.
"""

from __future__ import annotations

import math

from gcodesim.compiled import kernel
from gcodesim.processes.engagement_kernels import FROM, TO, Array
from gcodesim.processes.force_kernels import TORQUE

LEAST, MOST = 1.0e-3, 4.0  # advance over feed within which a chip is reckoned with
SAME_WAY = 1.0e-6  # [rad] between two directions that count as one
SLOWEST = 0.25  # of the rate of a tip that goes round at the distance of its bend
HELD = 4.0  # steps of bend against the travel, below which a tool counts as not held back


@kernel(lean=True)
def edge_wrench(
    tool: Array, laws: Array, circle: Array, ux: float, uy: float, rows: Array, weights: Array, used: int, wrench: Array
) -> None:
    """The part of `cutting_force` that no chip changes, from the contact that it has found: wrench (7,), torque last.

    The edge forces E of a law are the same at all angles, so that each row needs three sums over its contact.
    """
    wrench[:] = 0.0
    if laws[0, 2] == 0.0 and laws[1, 2] == 0.0 and laws[2, 2] == 0.0:
        return
    f_u, f_l, f_z, m_u, m_l, torque = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(used):
        all_of, sines, cosines = 0.0, 0.0, 0.0
        for k in range(int(rows[i, FROM]), int(rows[i, TO])):
            all_of += weights[i, k]
            sines += weights[i, k] * circle[0, k]
            cosines += weights[i, k] * circle[1, k]
        r, z, width = rows[i, 0], rows[i, 1], rows[i, 4]
        tangential = width * laws[0, 2]
        inward = width * (laws[1, 2] * rows[i, 2] + laws[2, 2] * rows[i, 3])
        along = width * (laws[1, 2] * rows[i, 3] - laws[2, 2] * rows[i, 2])
        row_u = -tangential * cosines - inward * sines
        row_l = tangential * sines - inward * cosines
        f_u += row_u
        f_l += row_l
        f_z += along * all_of
        m_u += r * along * cosines - z * row_l
        m_l += z * row_u - r * along * sines
        torque += r * tangential * all_of
    share = tool[1] / circle.shape[1]
    wrench[0], wrench[1], wrench[2] = share * (ux * f_u - uy * f_l), share * (uy * f_u + ux * f_l), share * f_z
    wrench[3], wrench[4] = share * (ux * m_u - uy * m_l), share * (uy * m_u + ux * m_l)
    wrench[5] = share * torque
    wrench[TORQUE] = share * torque


@kernel(lean=True)
def solve_advance(rubbed: float, pushed: float, bent: float, feed: float, asked: float, exponent: float) -> float:
    """Advance over feed [-] of a step that begins with the tip `bent` along the feed (0: as the command) [m].

    rubbed, pushed [m]: how far along the feed the tip gives way to the edge forces, and to the forces of chips at the
    advance `asked` > 0, which grow with the advance to the power `exponent`; feed > 0 [m]: commanded way of the step.

    Solves bent + (a - 1) feed = rubbed + pushed (a / asked)**exponent. Chips that pull the tool on, for ever thicker
    chips, are taken at the commanded feed: what holds it then is inertia.
    """
    if pushed >= 0.0:
        return 1.0
    low, high = LEAST, MOST
    a = min(max(asked, low), high)
    for _ in range(40):
        chips = pushed * (a / asked) ** exponent
        value = bent + (a - 1.0) * feed - rubbed - chips
        if value > 0.0:
            high = a
        else:
            low = a
        following = a - value / (feed - exponent * chips / a)
        if not (low <= following <= high):
            following = 0.5 * (low + high)
        if abs(following - a) < 1.0e-6 * a:
            return float(following)
        a = following
    return float(a)


@kernel(lean=True)
def turn_travel(travel: Array, feed: Array, bend: Array, advance: float, way: float) -> float:
    """Turn the direction `travel` (2,) of the tip towards that of the feed (2,), unit vectors; the cosine left.

    bend (>= 2,) [m]: deflection across the tool; advance [-]: of the tip over the feed; way [m]: commanded now.

    As long as force and bend delta keep their angle to the travel, d delta = advance travel - feed says, by its part
    across delta, how far all three turn in a step. On an arc of radius R that leaves a lag of b / R, b being the bend
    against the travel; round a corner the tip comes within some lengths of its bend. Where nothing holds it back, b
    being small, it turns at once.
    """
    across, cosine = travel[0] * feed[1] - travel[1] * feed[0], travel[0] * feed[0] + travel[1] * feed[1]
    size = math.sqrt(bend[0] * bend[0] + bend[1] * bend[1])
    against = -(bend[0] * travel[0] + bend[1] * travel[1])
    if against < HELD * way or (abs(across) < SAME_WAY and cosine > 0.0):
        travel[0], travel[1] = feed[0], feed[1]
        return 1.0
    pace = way / size
    turn = (bend[0] * (advance * travel[1] - feed[1]) - bend[1] * (advance * travel[0] - feed[0])) / size * pace
    side = 1.0 if (across if across != 0.0 else turn) > 0.0 else -1.0
    turn = max(side * turn, SLOWEST * pace * (abs(across) if cosine > 0.0 else 1.0))
    if turn >= math.atan2(abs(across), cosine):
        travel[0], travel[1] = feed[0], feed[1]
        return 1.0
    c, s = math.cos(turn), side * math.sin(turn)
    x, y = c * travel[0] - s * travel[1], s * travel[0] + c * travel[1]
    size = math.sqrt(x * x + y * y)
    travel[0], travel[1] = x / size, y / size
    return float(travel[0] * feed[0] + travel[1] * feed[1])
