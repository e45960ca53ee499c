from .large import LargeSystem as LargeSystem
from .survey import narrow_grids as narrow_grids
from .window import WindowStepper as WindowStepper
from .window import begun_in_window as begun_in_window
