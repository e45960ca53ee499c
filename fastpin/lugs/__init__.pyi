from .outline import Hole as Hole
from .outline import Lug as Lug
from .outline import Part as Part
from .outline import PartLoad as PartLoad
from .plates import PlateResult as PlateResult
from .plates import plate_compliance as plate_compliance
