"""Input and output around the phases: phases on files, plug-ins, job logs, Ctrl-C, YAML, text tables, former names."""
