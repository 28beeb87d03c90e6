(Header)
(from a drawing)
M3 S9000
(Header end.)
G21 (All units in mm)

(Start cutting path id: path1)
G00 Z5.000000
G00 X10.000000 Y20.000000

G01 Z-0.500000 F100.0(Penetrate)
G02 X20.000000 Y30.000000 Z-0.500000 I10.000000 J0.000000 F400.000000
G01 X20.000000 Y20.000000 Z-0.500000
G00 Z5.000000

(End cutting path id: path1)

(Footer)
M5
G00 X0.0000 Y0.0000
M2
