"""Conditions, loops, variables and expressions of RepRapFirmware (docs.duet3d.com, GCode meta commands, and
RepRapFirmware 3.5, StringParser.cpp and ExpressionParser.cpp)."""
