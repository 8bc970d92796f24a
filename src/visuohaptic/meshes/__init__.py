"""Phase `meshes`: from the models of the catalogue, or the user's own, to clean surfaces of unit size."""
