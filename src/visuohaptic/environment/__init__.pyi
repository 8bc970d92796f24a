from .exchange import PolicyAgent as PolicyAgent
from .exchange import agent_policy as agent_policy
from .single import TouchEnv as TouchEnv
from .vector import TouchVectorEnv as TouchVectorEnv
