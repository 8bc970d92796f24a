"""One page that reports what was run and what came out; nothing here computes a result that a phase could use."""
