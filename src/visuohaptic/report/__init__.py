"""One page that reports what was run and what came out, from the tables of all phases.

It reads tables and writes HTML; nothing here computes a result that another
phase could use.
"""
