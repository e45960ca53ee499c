from . import catalog as catalog
from . import records as records
from .handbook_formulas import half_angle as half_angle
from .handbook_formulas import load_term as load_term
from .handbook_formulas import peak_pressure as peak_pressure
from .records import Outcome as Outcome
from .records import Row as Row
