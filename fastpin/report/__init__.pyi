from . import checks as checks
from . import convergence as convergence
from . import cycle as cycle
from . import summary as summary
from . import sweep as sweep
from .case import describe as describe
from .states import state_table as state_table
