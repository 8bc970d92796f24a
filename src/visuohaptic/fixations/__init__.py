"""Phase `fixations`: from surfaces to views, saliency and ordered probing locations."""
