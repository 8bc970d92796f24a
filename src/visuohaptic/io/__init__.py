"""Around the phases: phases on files, plug-ins, logs of jobs, signals, names of former versions."""
