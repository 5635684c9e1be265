"""Symbols of the paper, with their equations in docs/theory.md, by the names of factors and fields of lines."""

#: Factors of the six sweeps of the paper's Section 5; the sixth, the composition, has no symbol.
FACTORS = {
    "friction": ("η", "1.1"),
    "radius": ("R", "1.1"),
    "load": ("P", "1.2"),
    "charge": ("T", "1.2"),
    "magnetic_charge": ("J", "1.2"),
}
#: Fields that the parametric study shows, in the paper's order.
FIELDS = {
    "contact_pressure": ("−σ_yy", "1.1"),
    "electric_displacement_y": ("D_y", "1b"),
    "magnetic_induction_y": ("B_y", "1c"),
    "stress_xx": ("σ_xx", "1a"),
    "electric_displacement_x": ("D_x", "1b"),
    "magnetic_induction_x": ("B_x", "1c"),
}
