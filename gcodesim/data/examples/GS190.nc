G21 G90 G17 G94
o1 if [#5410 LT 4]
(ABORT,the tool is too thin)
o1 endif
M2
