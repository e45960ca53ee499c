from .system import System as System
