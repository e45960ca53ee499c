from . import convergence as convergence
from . import stress as stress
from . import summary as summary
from . import sweep as sweep
from . import tolerances as tolerances
from .case import describe as describe
from .schema import json_schema as json_schema
from .states import state_table as state_table
