"""The world that a touch happens in, and the record of what was simulated of it."""
