from . import closed_forms as closed_forms
from . import interference as interference
from .checks import verify as verify
