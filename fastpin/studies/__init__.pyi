from . import convergence as convergence
from . import plan as plan
from . import sweep as sweep
from .convergence import converge as converge
from .plan import parse_plan as parse_plan
from .plan import read_plan as read_plan
from .workers import cores as cores
