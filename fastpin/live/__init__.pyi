from .recording import record_joint_page as record_joint_page
from .recording import record_life as record_life
from .recording import record_page as record_page
from .recording import recorded_places as recorded_places
from .server import serve as serve
