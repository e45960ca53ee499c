from .bushing import Bushing as Bushing
from .compliance import Compliance as Compliance
from .disk import Disk as Disk
from .plate import Plate as Plate
from .ring import Ring as Ring
from .tube import Tube as Tube
