"""What accuracy costs in time: settings, their error rates and seconds, and the front between the two."""
