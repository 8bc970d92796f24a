"""Study `packaged_model`: the model that the package brings, and how often its answers are right."""
