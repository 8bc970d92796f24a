"""Study `variants`: its design, the rules that judge it, its kept tables, and its page."""
