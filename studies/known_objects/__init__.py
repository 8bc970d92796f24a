"""Study `known_objects`: which of the known objects is touched, in a pose that training did not see."""
