"""Choose descriptors of touches for objects of unknown pose."""
