from .wear_result import WearResult as WearResult
from .wear_result import WornCycle as WornCycle
