"""The laws of crack growth. They stand in :mod:`fastpin.model.growth`, for a material may have one."""

from fastpin.model.growth import GrowthLaw as GrowthLaw
from fastpin.model.growth import Nasgro as Nasgro
from fastpin.model.growth import Walker as Walker
from fastpin.model.growth import intrinsic_length as intrinsic_length
from fastpin.model.growth import paris as paris
