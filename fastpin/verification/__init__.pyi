from . import closed_forms as closed_forms
from . import interference as interference
from .checks import verify as verify
from .sliding import solve_sliding as solve_sliding
