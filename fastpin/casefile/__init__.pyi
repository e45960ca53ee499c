from .reader import EXAMPLE as EXAMPLE
from .reader import builtin_case as builtin_case
from .reader import parse_case as parse_case
from .reader import read_case as read_case
