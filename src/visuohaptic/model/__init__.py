"""Phase `model`: from the features of a run to the model that it leaves behind."""
