from .bushing import Bushing as Bushing
from .compliance import Compliance as Compliance
from .pins import Disk as Disk
from .pins import Tube as Tube
from .plate import Plate as Plate
from .ring import Ring as Ring
