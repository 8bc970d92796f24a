"""Each strategy in a module of its own: a run depends on those alone that it uses."""
