from .joint import JointSession as JointSession
from .session import Session as Session
