"""Built-in live views: ``foxglove`` and ``rerun``; each is a module of its own, for each needs an extra."""
