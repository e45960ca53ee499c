from . import error_bars as error_bars
from . import extremes as extremes
from .load_cycle import LoadCycle as LoadCycle
from .load_cycle import Loop as Loop
from .load_cycle import NodeBehaviour as NodeBehaviour
from .quantities import QUANTITIES as QUANTITIES
from .regimes import Regime as Regime
from .state import State as State
