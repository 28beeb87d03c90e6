(feed_depth: one slot across a block, as deep and as fast as a study says)
(stock 40 x 30 x 10, zero top front left, AlMgSi1; T1 end mill 6)
(without a study 2 mm deep at 400 mm/min)
o1 if [EXISTS[#<depth>] EQ 0]
  #<depth> = 2
o1 endif
o2 if [EXISTS[#<feed>] EQ 0]
  #<feed> = 400
o2 endif
G21 G90 G17 G94 G54 G61
T1 M6
G43 H1
S8000 M3
G0 X-5 Y15 Z3
G1 Z-#<depth> F1000
X45 F#<feed>
G0 Z20
M5
M2
