from .quantities import QUANTITIES as QUANTITIES
from .state import State as State
