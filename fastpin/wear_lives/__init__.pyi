from .joint_life import JointWearResult as JointWearResult
from .joint_life import WornJoint as WornJoint
from .joint_life import wear_joint as wear_joint
from .wear_result import WearResult as WearResult
from .wear_result import WornCycle as WornCycle
