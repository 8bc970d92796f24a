"""Study `variants`: the design, the rules that judge the results, the kept tables, and the page."""
