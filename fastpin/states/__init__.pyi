from .quantities import QUANTITIES as QUANTITIES
from .state import State as State
from .stress import Stress as Stress
from .stress import stress_at as stress_at
from .stress import tractions_of as tractions_of
