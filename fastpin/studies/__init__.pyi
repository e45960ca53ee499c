from . import convergence as convergence
from . import outcomes as outcomes
from . import plan as plan
from . import sweep as sweep
from .convergence import converge as converge
from .outcome_tables import read_outcomes as read_outcomes
from .plan import parse_plan as parse_plan
from .plan import read_plan as read_plan
