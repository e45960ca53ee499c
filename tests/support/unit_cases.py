"""Cases of many kinds in SI units, each with the commands that show its outputs."""

HEAD = """
[pin]
E = 210e9
nu = 0.3
yield_strength = 900e6
[plate]
E = 71e9
nu = 0.33
yield_strength = 345e6
ultimate_strength = 483e6
%s
[contact]
hole_radius = 6e-3
clearance = 20e-6
friction = 0.3
%s
"""

TAIL = """
[solve]
nodes = 31
between = 1
"""

FORCES = """
[[load]]
P = %r
[[load]]
P = [%r, %r]
repeat = 2
"""

N, N_PER_M = FORCES % (4e3, 1e3, 4e3), FORCES % (4e5, 1e5, 4e5)

FATIGUE = """
[plate.fatigue]
fatigue_strength = 1.1e9
strength_exponent = -0.124
fatigue_ductility = 0.22
ductility_exponent = -0.59
threshold_range = 3e6
limit_range = 150e6
"""

CURVE = """
[plate.fatigue]
curve_a = 88.12
curve_b = 9.84
curve_c = 0.0
curve_m = 0.45
curve_kt = 1.0
curve_scatter = 0.2
"""

LAW = 'law = { law = "walker", C = 1e-10, m = 3.0, threshold_range = 1e6, intrinsic_length = 1e-4, toughness = 30e6 }'

LAMINATE = """
[pin]
E = 210e9
nu = 0.3
[plate]
layup = "[0/45/-45/90]2s"
ply = { E1 = 181e9, E2 = 10.3e9, G12 = 7.17e9, nu12 = 0.28, thickness = 125e-6, Xt = 1.5e9, Xc = 1.5e9, Yt = 40e6, Yc = 246e6, S = 68e6 }
[contact]
plane = "stress"
hole_radius = 3e-3
clearance = 10e-6
friction = 0.2
"""  # noqa: E501

THICK = "thickness = 5e-3"

SHORT = ["run case.toml -o a.h5 --json run.json --cycle-csv run.csv", "show a.h5 --json show.json", "check case.toml"]


def text(*parts: str, plate: str = "", contact: str = THICK) -> str:
    """A case with further keys of plate and contact, and with these parts behind them."""
    return "".join([HEAD % (plate, contact), *parts, TAIL])


GAP = """
[gap]
hole = [{ ellipse = 2e-6, axis = 30 }, { lobes = 3, size = 1e-6 }]
pin = { flat = 1e-6, centre = 0 }
[[load]]
mean = { P = 3e5, sxx = 20e6 }
amplitude = { P = 1e5, sxy = 5e6 }
phase = { P = 30 }
points = 8
"""

RING = "[pin_body]\nbore_radius = 2e-3\n[plate_body]\nouter_radius = 15e-3\n"

BUSH = """
[plate_body]
outer_radius = 8e-3
E = 110e9
nu = 0.34
interference = 15e-6
bonded = false
friction = 0.2
"""

HELD = f'{THICK}\npin_load = "centre"\nrotation = "spring"\nhub_stiffness = 2e3\nhub_radius = 3e-3'
DRIVEN = f'{THICK}\npin_load = "centre"\ndrive = "ux"\ngauge_radius = 30e-3\nrig_stiffness = 1e10'
MOVED = "[[load]]\nP = 4000.0\n[[load]]\nux = [3e-6, -3e-6]\nrepeat = 2\n"

POINT = """
[fatigue]
criterion = "smith-watson-topper"
bodies = "plate"
method = "point"
length = 50e-6
"""

RELIABLE = """
[fatigue]
criterion = "stress-life"
bodies = "plate"
reliability = 0.99
residual_stress = [[0.0, -100e6], [1e-3, 0.0]]
"""

CRACK = f"[crack]\nfirst = 0.2e-3\nlast = 2e-3\ntheta = 0.0\nresidual_stress = -20e6\n{LAW}\n"

STRENGTH = f'{FORCES % (2e3, 500.0, 2e3)}[strength]\ncriterion = "hashin"\ndistance = 0.2e-3\n'

WEAR = "[wear]\ncycles = 3\npin = 2e-14\nplate = { constant = 1e-14 }\n"

CASES = {
    "infinite plate": (text(N_PER_M, contact=""), SHORT),
    "yield": (text(FORCES % (4e4, 1e4, 4e4)), SHORT),
    "hollow pin in a ring": (text(RING, N, contact=f'{THICK}\nplane = "stress"'), SHORT),
    "bush that slips": (text(BUSH, N), ["run case.toml --json run.json --cycle-csv run.csv"]),
    "held pin with a spring": (text(N, contact=HELD), SHORT),
    "prescribed displacement of a rig": (text(MOVED, contact=DRIVEN), SHORT),
    "gap and remote stress": (text(GAP, contact=""), SHORT),
    "fatigue at a critical distance": (text(N, POINT, plate=FATIGUE), SHORT),
    "curve with scatter and residual stress": (text(N, RELIABLE, plate=CURVE), SHORT),
    "crack": (text(N, CRACK), SHORT),
    "laminate": (f"{LAMINATE}thickness = 2e-3\n{STRENGTH}{TAIL}", SHORT),
    "wear": (
        text(N, WEAR),
        ["wear case.toml -o life.h5 --json wear.json", "show life.h5"],
    ),
}
"""The text of a case, and its commands, by what it shows."""
