"""What each effect costs, and how far it moves images and accuracy."""
