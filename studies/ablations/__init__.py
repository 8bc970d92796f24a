"""Study `ablations`: leave out or replace one part of the method at a time."""
