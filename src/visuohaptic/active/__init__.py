"""Policies, which choose each touch by the touches before.

`registry` lists the policies beside the planned strategies, and phase `touches` runs them by
`sessions.touch_by_policies`.
"""
