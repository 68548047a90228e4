"""Looking into a run: pause, step, breakpoints, time travel."""
