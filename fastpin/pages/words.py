"""Words for the quantities, loads, options and residuals of a page."""

from __future__ import annotations

QUANTITY_WORDS = {
    "peak_pressure": "largest contact pressure N",
    "peak_pressure_angle": "its place",
    "peak_shear": "largest shear traction T, with its sign",
    "peak_shear_angle": "its place",
    "contact_width": "width of the contact",
    "stick_width": "width of the stick zones",
    "rotation": "rotation of the pin, counter-clockwise",
    "dx": "motion of the pin to the right",
    "dy": "motion of the pin upwards",
    "P": "force of the tractions on the pin, P",
    "Q": "force of the tractions on the pin, Q",
    "M": "moment of the tractions on the pin, M",
    "pressure_integral": "integral of N round the hole",
    "shear_integral": "integral of T round the hole",
    "shear_magnitude": "integral of |T| round the hole",
    "dissipation": "energy dissipated so far",
    "work": "work of the loads so far",
    "peak_hoop": "largest hoop stress round the hole",
    "peak_hoop_angle": "its place",
    "kt_gross": "its ratio to the remote stress, Kt gross",
    "kt_bearing": "its ratio to the bearing stress, Kt bearing",
    "kt_net": "its ratio to the net-section stress, Kt net",
    "peak_hoop_seat": "largest hoop stress of the plate at the seat of the bush",
    "peak_hoop_seat_angle": "its place",
    "joint_ux": "displacement of the joint to the right",
    "joint_uy": "displacement of the joint upwards",
    "bush_open_margin": "least pressure between bush and plate",
    "bush_slip_margin": "least pressure between bush and plate, minus shear over friction",
    "regime": "regime of the contact",
}
"""Words for :data:`fastpin.states.QUANTITIES`."""

LOAD_WORDS = {
    "P": "force on the pin downwards",
    "Q": "force on the pin to the right",
    "M": "moment on the pin, counter-clockwise",
    "sxx": "remote stress of the plate along x",
    "syy": "remote stress of the plate along y",
    "rotation": "prescribed rotation of the pin, counter-clockwise",
    "sxy": "remote shear stress of the plate",
    "ux": "prescribed displacement of the pin to the right",
    "uy": "prescribed displacement of the pin upwards",
}
"""Words for :data:`fastpin.model.LOADS`."""

OPTION_WORDS = {
    "nodes": "number of nodes on the arc or circle",
    "method": "path: exact in load; increment: implicit load increments",
    "increments": "increments of each step",
    "arc": "ends of the arc of nodes, rad",
    "between": "states inside each step: their number, or fractions of the step",
    "keep": "states that are kept",
    "shortcut": "states of a periodic contact are copied from the period before, with the same bits",
    "error_bars": "the history is also followed on a grid with half the intervals",
    "slip_sums": "slip distance and friction energy of each node are counted",
}
"""Words for the fields of :class:`fastpin.SolveOptions`."""

RESIDUAL_WORDS = {
    "gap": "no gap where the bodies touch, in parts of the largest displacement",
    "slip": "no change of slip where they stick, in parts of the largest displacement",
    "cone": "Coulomb's law and N >= 0, in parts of the largest pressure",
    "equilibrium": "equilibrium of the pin, in parts of the resultants of the absolute tractions",
}
"""Words for the residuals of a :class:`fastpin.State`."""
