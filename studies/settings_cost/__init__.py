"""Study `settings_cost`: accuracy against time; each family of settings varies one parameter."""
