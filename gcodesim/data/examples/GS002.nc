G21 G90 G17 G94
G0 X10 (a comment that goes on and on, a comment that goes on and on, a comment that goes on and on, a comment that goes on and on, a comment that goes on and on, a comment that goes on and on, a comment that goes on and on, a comment that goes on and on, a comment that goes on and on, )
M2
