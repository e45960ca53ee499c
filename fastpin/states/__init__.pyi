from .quantities import QUANTITIES as QUANTITIES
from .state import State as State
from .stress import Stress as Stress
