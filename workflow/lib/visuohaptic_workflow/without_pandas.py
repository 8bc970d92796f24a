"""Deny pandas to the imports of a script: scikit-learn takes 0.2 s to import it, and works without.

A script imports this module before all others. `visuohaptic_workflow.jobs.job` allows pandas again, for plug-ins and
studies of the user.
"""

from __future__ import annotations

from visuohaptic.base.optional_packages import deny_pandas

deny_pandas()
