"""The strategies and the policy, one module each."""
