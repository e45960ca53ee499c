from . import crack as crack
from . import fatigue as fatigue
from . import margins as margins
from . import outputs as outputs
from . import strength as strength
from . import wear as wear
