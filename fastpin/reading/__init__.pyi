from . import hoop as hoop
from . import joint as joint
from . import refined as refined
from . import stress as stress
from .joint import BushFit as BushFit
from .stress import HoopPeak as HoopPeak
from .stress import Stress as Stress
