"""The text of a case file without the sections of its bodies."""

HEAD = """[pin]
material = "steel"
[plate]
material = "aluminium"
[contact]
hole_radius = 10e-3
clearance = 20e-6
friction = 0.3
[[load]]
P = 1e6
"""
