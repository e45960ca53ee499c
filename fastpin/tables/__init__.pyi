from .columns import column_choices as column_choices
from .files import history_from_csv as history_from_csv
from .files import read_samples as read_samples
from .load_units import Basis as Basis
