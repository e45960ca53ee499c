from . import catalog as catalog
from . import text as text
from .formulas import half_angle as half_angle
from .formulas import load_term as load_term
from .formulas import peak_pressure as peak_pressure
from .rows import Outcome as Outcome
from .rows import Row as Row
