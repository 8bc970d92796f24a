"""Study `views`: what one more view of an object gains."""
