"""Fanuc's own machinery behind the dialect `fanuc`: custom macros, work systems, figures and cycles."""
