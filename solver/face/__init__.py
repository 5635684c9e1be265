"""The labelled face: named factors in, arrays with names and units out (``solve``, ``solve_interior``)."""
