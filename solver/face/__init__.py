"""The labelled face of the solver, from named factors to arrays with names and units."""
