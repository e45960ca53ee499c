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

LAMINATED = """
[pin]
material = "steel"
[plate]
layup = "[0/45/-45/90]2s"
ply = "T300/914"
[contact]
plane = "stress"
hole_radius = 3e-3
clearance = 20e-6
friction = 0.2
[[load]]
P = 1e6
"""
"""A steel pin in a laminate whose plies have strengths, pressed down."""

FATIGUED = """\
title = "A repeated Q"
pin.material = "Ti-6Al-4V"
plate.material = "2024-T3"
[contact]
hole_radius = 10e-3
clearance = 40e-6
friction = 0.4
[[load]]
P = 3e6
[[load]]
Q = [7e5, -7e5]
repeat = 3
[fatigue]
small_cycles = "haibach"
knee = 1e6
[solve]
nodes = 31
"""
"""A pin that a repeated force Q moves in a sheet, with a section of fatigue."""

IN_CYCLES = """
pin.material = "steel"
plate = { E = 70e9, nu = 0.33, growth = { law = "walker", C = 1e-10, m = 3, exponent = 0.5, source = "own tests" } }
[contact]
hole_radius = 10e-3
clearance = 20e-6
friction = 0.3
[[load]]
P = [3e6, 3e5]
repeat = 2
[solve]
nodes = 61
"""
"""A steel pin in a plate with a law of growth, under a force that rises and falls."""

IN_A_RIG = """
[pin]
material = "Ti-6Al-4V"
[plate]
material = "Ti-6Al-4V"
[contact]
hole_radius = 5e-3
clearance = 30e-6
friction = 0.5
pin_load = "centre"
rotation = "fixed"
drive = "ux"
[[load]]
P = 6000
"""
"""A titanium pin that a rig drives along x, pressed down."""

STEEL_IN_LAMINATE = """\
pin.material = "steel"
plate = { layup = "[0/45/-45/90]2s", ply = "T300/914" }
[contact]
plane = "stress"
hole_radius = 3e-3
clearance = 20e-6
friction = 0.2
thickness = 2e-3
"""
"""Bodies and contact of a steel pin in a laminate, without loads."""
