"""Study `settings_cost`: accuracy against time in many settings, one thing varied at a time."""
