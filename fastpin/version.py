"""The version of fastpin."""

__version__ = "0.1.0"
