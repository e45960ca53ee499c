from .friction import follow_friction as follow_friction
from .path import DriftPath as DriftPath
