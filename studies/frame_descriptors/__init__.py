"""Which descriptors of touches serve an object of unknown pose best."""
