from .contact import LiveContact as LiveContact
from .recording import record_page as record_page
from .server import Server as Server
from .server import serve as serve
