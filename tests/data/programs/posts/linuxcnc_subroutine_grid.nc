o<pocket> sub (x, y, depth)
  #<z> = 0
  G0 X#1 Y#2
  G0 Z2
  o100 while [#<z> GT -#3]
    #<z> = [#<z> - 1]
    o110 if [#<z> LT -#3]
      #<z> = [0 - #3]
    o110 endif
    G1 Z#<z> F150
    G1 X[#1 + 8] F600
    G1 Y[#2 + 8]
    G1 X#1
    G1 Y#2
  o100 endwhile
  G0 Z10
o<pocket> endsub

G21 G90 G94 G17 G40 G49
T1 M6
G43
S8000 M3
G0 Z10
#<column> = 0
o200 repeat [3]
  o<pocket> call [#<column> * 15] [5] [2.5]
  #<column> = [#<column> + 1]
o200 endrepeat
M5
G53 G0 Z0
M2
