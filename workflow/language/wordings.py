"""What names are called on the page and in messages, where their own words do not say it."""

#: What names are called whose words alone do not say it.
TITLES = {
    "volume_fraction": "volume fraction",
    "contact_trailing": "trailing extent of the contact",
    "contact_leading": "leading extent of the contact",
    "trailing_tension": "tension behind the contact",
    "leading_compression": "stress ahead of the contact",
    "peak_pressure": "contact pressure",
    "voltage_sensitivity": "voltage per load",
    "magnetic_sensitivity": "magnetic potential per load",
    "charge_sensitivity": "charge per force",
    "flux_sensitivity": "flux per force",
    "nominal_field": "electric field over the thickness",
    "peak_von_mises": "von Mises stress in the body",
    "peak_principal_tension": "tension in the body",
    "film_peak_von_mises": "von Mises stress in the film",
    "film_peak_principal_tension": "tension in the film",
    "interface_shear": "shear of the interface",
    "interface_tension": "tension of the interface",
    "smallest_force": "smallest detectable force",
    "drive_field": "driving field",
    "electric_displacement_y": "normal electric displacement",
    "magnetic_induction_y": "normal magnetic induction",
    "stress_xx": "stress along the surface",
}
