"""Better by practice: searches that need only the cost of a try."""
