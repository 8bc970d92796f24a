"""Code of the workflow: plan jobs, compute their keys, and run and record them."""
