"""Phase `fixations`: from surfaces to views, saliency maps and ordered probing locations."""
