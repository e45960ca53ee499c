from .plates import PlateResult as PlateResult
from .plates import plate_compliance as plate_compliance
