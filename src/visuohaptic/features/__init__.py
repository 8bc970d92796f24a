"""Phase `features`: from imprints to 16 contourlet and 6 kinesthetic features per touch."""
