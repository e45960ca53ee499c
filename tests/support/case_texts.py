"""Texts of small cases."""

PRESSED = """
[pin]
material = "steel"
[plate]
material = "steel"
[contact]
hole_radius = 0.01
clearance = 1e-5
friction = 0.3
[[load]]
P = 1e6
"""
"""A free steel pin in a steel plate, pressed down."""
