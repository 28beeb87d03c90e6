G21 G90
#<depth> = 2
G1 Z-#<depth> F100
M2
