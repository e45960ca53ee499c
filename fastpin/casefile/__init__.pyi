from .lug import LUG_EXAMPLE as LUG_EXAMPLE
from .lug import LugFile as LugFile
from .lug import parse_lug as parse_lug
from .lug import read_lug as read_lug
from .reader import EXAMPLE as EXAMPLE
from .reader import builtin_case as builtin_case
from .reader import parse_case as parse_case
from .reader import read_case as read_case
