G21 G90
G1 X5 F100 (expect: feed missing)
M2
