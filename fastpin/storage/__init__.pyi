from .export import to_dataframe as to_dataframe
from .export import to_xarray as to_xarray
from .recording import record as record
from .recording import resume as resume
from .recording import stored_case as stored_case
from .store import load as load
from .store import save as save
from .store import state_count as state_count
