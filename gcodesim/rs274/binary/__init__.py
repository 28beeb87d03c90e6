"""Binary G-code, as PrusaSlicer writes it for some printers: bytes in, the text that they stand for out.

The format is that of libbgcode (doc/specifications.md, version 1).
"""
